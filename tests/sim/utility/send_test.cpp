// `ex9000 send` with simulated modules.
#include <gtest/gtest.h>

#include <utility>

#include "tests/sim/utility/plant.hpp"

namespace ex9000::utility {
namespace {

TEST(Send, PrintsARequestAndItsReplyInWords) {
  Plant modbus({"EX9052D-M@05"});
  EXPECT_EQ(modbus.run({"send", "port", "05", "03", "0000", "0001"}), 0);
  EXPECT_EQ(modbus.output(),
            "> 05 03 00 00 00 01 85 8E  ; 05: Read Holding Registers 0000 x 1, input counters\n"
            "< 05 03 02 00 00 49 84  ; 05: Read Holding Registers, reply\n");
  EXPECT_EQ(modbus.run({"send", "port", "05 06 0000 0001"}), 0);
  EXPECT_NE(modbus.output().find("exception 02"), std::string::npos) << modbus.output();

  Plant dcon({"EX9052D@05"});
  EXPECT_EQ(dcon.run({"send", "port", "$05M"}), 0);
  EXPECT_EQ(dcon.output(), "> $05M\\r  ; $AAM: read the module's name\n< !059052\\r  ; reply\n");
}

/// wire.md section 3: `$012` + `B7`.
TEST(Send, AddsAChecksum) {
  Plant plant({"EX9052D@01,checksum=on"});
  EXPECT_EQ(plant.run({"send", "port", "$012", "--checksum"}), 0);
  EXPECT_EQ(plant.sent.back(), (Data{'$', '0', '1', '2', 'B', '7', '\r'}));
  EXPECT_EQ(plant.run({"send", "port", "$012"}), 1);
  EXPECT_EQ(plant.error(), "ex9000: no reply\n");
}

TEST(Send, LeavesOutTheEchoOfTheRequest) {
  Plant plant({"EX9052D@01"});
  plant.echoes = true;
  EXPECT_EQ(plant.run({"send", "port", "$01M"}), 0);
  EXPECT_NE(plant.output().find("\n< !019052\\r"), std::string::npos) << plant.output();
}

TEST(Send, ARequestToAllModulesGetsNoReply) {
  Plant plant({"EX9052D@01"});
  for (const char* request : {"#**", "00 05 0000 FF00"}) {
    EXPECT_EQ(plant.run({"send", "port", request}), 0);
    EXPECT_NE(plant.output().find("\nno reply, as always to all modules\n"), std::string::npos)
        << plant.output();
  }
}

TEST(Send, RefusesARequestThatIsNone) {
  const std::pair<std::vector<std::string>, const char*> kRows[] = {
      {{"send", "port"}, "expected ex9000 send PORT REQUEST...\n"},
      {{"send", "port", "01"}, "'01': expected a DCON command, as $01M, or an address and a function in hex"},
      {{"send", "port", "01", "zz"}, "'01 zz': expected"},
      {{"send", "modbus-tcp:host", "$01M"}, "'$01M': Modbus TCP carries no DCON; name another port\n"},
  };
  for (const auto& [words, problem] : kRows) {
    Plant plant({"EX9052D@01"});
    EXPECT_EQ(plant.run(words), 2);
    EXPECT_EQ(plant.error().find("ex9000: " + std::string(problem)), 0U) << plant.error();
    EXPECT_TRUE(plant.sent.empty());
  }
}

}  // namespace
}  // namespace ex9000::utility
