// Updates simulated modules with the program ex9000, and with mbpoll and the script in
// firmware/update-a-module.md. The requests of the script are those of Wiren Board's wb-mcu-fw-flasher: the
// information block, then each block, from the file.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/firmware/update/messages.hpp"
#include "tests/support/in_repository.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {
namespace {

using update::Buffer;

/// Version 01.07 for an EX9042D-M on a Pico. Returns its path.
std::string write_update(const std::string& directory) {
  const Buffer image = update::image_of(1000);
  Buffer file = update::info_of(image, 0x0107, update::kActivateWhenComplete);
  for (std::uint32_t offset = 0; offset < image.size(); offset += update::kBlockSize) {
    const Buffer block = update::block_of(image, offset);
    file.insert(file.end(), block.begin(), block.end());
  }
  const std::string path = directory + "/update.ex9fw";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  return path;
}

class Update : public testing::Test {
 protected:
  Finished send(const SimulatorProcess& simulator, const std::vector<std::string>& arguments) {
    std::vector<std::string> command{in_repository(EX9000_UTILITY), "update"};
    for (const std::string& argument : arguments) {
      command.push_back(argument == "FILE" ? write_update(simulator.directory()) : argument);
    }
    return run(command);
  }
};

TEST_F(Update, TheUtilityUpdatesSeveralModulesAndWaitsUntilTheyAreConfirmed) {
  SimulatorProcess simulator({"EX9042D-M@01,baud=115200", "EX9042D-M@02,baud=115200,serial=1F3A",
                              "EX9052D-M@03,baud=115200", "--speed=10", "--log"});
  const Finished sent =
      send(simulator, {"--baud", "115200", "--wait", simulator.tty(), "1,0D001F3A", "FILE"});
  EXPECT_EQ(sent.status, 0) << sent.output << sent.error;
  EXPECT_TRUE(simulator.wait_for("version 0107", 2));
}

TEST_F(Update, TheUtilityRefusesModulesThatTheFileIsNotFor) {
  SimulatorProcess simulator({"EX9042D-M@01", "EX9052D-M@03"});
  const Finished sent = send(simulator, {simulator.tty(), "1,3", "FILE"});
  EXPECT_EQ(sent.status, 1);
  EXPECT_NE((sent.output + sent.error).find("9052DM.pico"), std::string::npos) << sent.output << sent.error;
  EXPECT_EQ(simulator.output().find("version 0107"), std::string::npos);
}

TEST_F(Update, TheUtilityRepeatsWhatIsLost) {
  SimulatorProcess simulator(
      {"EX9042D-M@01,baud=115200,fault=lost-reply every 7th reply", "--port=tcp:0", "--speed=10", "--log"});
  const Finished sent =
      send(simulator, {"tcp:127.0.0.1:" + std::to_string(simulator.tcp_port()), "1", "FILE"});
  EXPECT_EQ(sent.status, 0) << sent.output << sent.error;
  EXPECT_TRUE(simulator.wait_for("version 0107"));
}

TEST_F(Update, TheUtilityReportsAnImageThatIsTakenBack) {
  SimulatorProcess simulator(
      {"EX9042D-M@01,baud=115200,fault=bad-image", "--port=modbus-tcp:0", "--speed=10", "--log"});
  const Finished sent = send(
      simulator, {"--wait", "modbus-tcp:127.0.0.1:" + std::to_string(simulator.tcp_port()), "1", "FILE"});
  EXPECT_EQ(sent.status, 1);
  EXPECT_NE((sent.output + sent.error).find("has taken the image back"), std::string::npos)
      << sent.output << sent.error;
  EXPECT_TRUE(simulator.wait_for("version 0100"));
}

TEST_F(Update, MbpollSendsAnUpdateWithTheScriptInTheDocument) {
  std::ifstream document(in_repository("firmware/update-a-module.md"));
  const std::string text{std::istreambuf_iterator<char>(document), {}};
  const std::size_t begin = text.find("words() {");
  ASSERT_NE(begin, std::string::npos);
  const std::string script = text.substr(begin, text.find("```", begin) - begin);
  SimulatorProcess simulator({"EX9042D-M@01", "--log"});
  write_update(simulator.directory());
  const Finished sent = run({"bash", "-c", script}, simulator.directory());
  EXPECT_EQ(sent.status, 0) << sent.output << sent.error;
  EXPECT_TRUE(simulator.wait_for("version 0107"));
}

}  // namespace
}  // namespace ex9000::system
