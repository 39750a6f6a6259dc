// `ex9000 scan` and `address` with simulated modules.
#include <gtest/gtest.h>

#include <cstdlib>
#include <utility>

#include "sim/text/values.hpp"
#include "sim/utility/command/scan_line.hpp"
#include "tests/sim/utility/plant.hpp"

namespace ex9000::utility {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines = sim::parts_of(text, '\n');
  lines.pop_back();
  return lines;
}

TEST(Scan, FindsModulesOfBothProtocolsInOneMode) {
  Plant plant(
      {"EX9042D-M@01", "EX9052D-M@01,serial=1F3A", "EX9043D@03,name=VALVE", "EX9055D@04,checksum=on"});
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "0-5"}), 0);
  EXPECT_EQ(
      lines_of(plant.output()),
      (Lines{
          "1 (01)  modbus 9600 baud 8N1  EX9042D-M '9042M'  D01.00  0D000001  last reset: power-on",
          "1 (01)  modbus 9600 baud 8N1  EX9052D-M '9052M'  D01.00  0D001F3A  last reset: power-on",
          "3 (03)  ascii 9600 baud 8N1  unknown model 'VALVE'  D01.00  0D000003  last reset: power-on",
          "4 (04)  ascii 9600 baud 8N1 checksum  EX9055D '9055'  D01.00  0D000004  last reset: power-on"}));
  EXPECT_NE(plant.error().find(
                "2 modules have the address 1 at 9600 baud 8N1; give each its own with 'ex9000 address"),
            std::string::npos)
      << plant.error();
}

TEST(Scan, FindsModulesInEveryMode) {
  const std::vector<std::pair<std::string, std::string>> kModes{{"1200", "8N1"},  {"2400", "8E1"},
                                                                {"19200", "8N1"}, {"38400", "8O1"},
                                                                {"57600", "8N2"}, {"115200", "8E1"}};
  std::vector<std::string> modules;
  for (const auto& [baud, format] : kModes) {
    const std::string number = std::to_string(modules.size() + 1);
    modules.push_back((modules.size() % 2 == 0 ? "EX9052D-M@0" : "EX9052D@0") + number + ",baud=" + baud +
                      ",format=" + format);
  }
  Plant plant(modules);
  EXPECT_EQ(plant.run({"scan", "port", "--addresses", "1-6"}), 0);
  for (const auto& [baud, format] : kModes) {
    const std::string shown = baud + " baud " + (format == "8N2" ? "8N1" : format);
    EXPECT_NE(plant.output().find(shown), std::string::npos) << plant.output() << shown;
  }
  EXPECT_EQ(lines_of(plant.output()).size(), kModes.size()) << plant.output();
}

/// What a master could see of the modules is as before: the reset status too.
TEST(Scan, ChangesAndClearsNothing) {
  Plant plant({"EX9052D-M@01", "EX9043D@02"});
  plant.act("1 pulse 3 x5");
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "1-2"}), 0);
  EXPECT_EQ(plant.run({"send", "port", "$025"}), 0);
  EXPECT_NE(plant.output().find("< !021"), std::string::npos) << plant.output();
  EXPECT_EQ(plant.run({"send", "port", "01 03 0003 0001"}), 0);
  EXPECT_NE(plant.output().find("< 01 03 02 00 05"), std::string::npos) << plant.output();
  EXPECT_EQ(plant.run({"send", "port", "01 03 0305 0001"}), 0);
  EXPECT_NE(plant.output().find("< 01 03 02 00 00"), std::string::npos) << plant.output();
}

/// An original module does not know the scan by serial number; here one that a fault silences for it.
/// The second one takes no part in the scan by serial numbers.
TEST(Scan, ShowsAModuleBesideOneWithASerialNumber) {
  Plant plant({"EX9042D-M@01", "EX9052D-M@01"});
  plant.act("2 power off");
  plant.sends = [&, by_address = false](const Data& frame) mutable {
    if (frame[0] != 0xFD && !std::exchange(by_address, true)) {
      plant.act("2 power on");
      plant.wait();
    }
    return true;
  };
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--modbus"}), 0);
  EXPECT_EQ(
      lines_of(plant.output()),
      (Lines{
          "1 (01)  modbus 9600 baud 8N1  EX9042D-M '9042M'  D01.00  0D000001  last reset: power-on",
          "1 (01)  modbus 9600 baud 8N1  bytes, but no reply: several modules with this address, or noise"}));
}

TEST(Scan, AsksEachAddressInModbusToo) {
  Plant plant({"EX9042D-M@07"});
  plant.sends = [](const Data& frame) { return frame[0] != 0xFD; };
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--modbus"}), 0);
  EXPECT_EQ(lines_of(plant.output()).size(), 1U) << plant.output();
  EXPECT_EQ(plant.output().find("7 (07)  modbus 9600 baud 8N1  EX9042D-M '9042M'  D01.00  0D000001"), 0U)
      << plant.output();
}

TEST(Scan, ShowsBytesThatAreNoReply) {
  Plant plant({"EX9042D-M@07", "EX9052D-M@07"});
  plant.sends = [](const Data& frame) { return frame[0] != 0xFD; };
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "7"}), 0);
  EXPECT_NE(plant.output().find("7 (07)  modbus 9600 baud 8N1  bytes, but no reply: several modules"),
            std::string::npos)
      << plant.output();
}

/// Noise is not twice in the same place.
TEST(Scan, TakesNoiseForNoOtherModule) {
  Plant plant({"EX9042D-M@01"});
  bool disturbed = false;
  plant.sends = [&](const Data& frame) {
    disturbed = !disturbed && frame[0] == 1;
    return true;
  };
  plant.hears = [&](std::size_t at, std::uint8_t byte) {
    return std::optional(disturbed && at == 2 ? static_cast<std::uint8_t>(byte ^ 1U) : byte);
  };
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--modbus", "--addresses", "1"}),
            0);
  EXPECT_EQ(lines_of(plant.output()).size(), 1U) << plant.output();
}

/// As a late one is.
TEST(Scan, TakesNoReplyOfAnotherModule) {
  Plant plant({"EX9052D@06"});
  plant.replies = [](const Data& frame) -> std::optional<Data> {
    const std::string reply = "!06400600\r";
    return frame.size() > 2 && frame[2] == '5' ? std::optional(Data(reply.begin(), reply.end()))
                                               : std::nullopt;
  };
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "5-6", "--ascii"}),
            0);
  EXPECT_NE(plant.output().find("5 (05)  ascii 9600 baud 8N1  bytes, but no reply: "), std::string::npos)
      << plant.output();
  EXPECT_NE(plant.output().find("6 (06)  ascii 9600 baud 8N1  EX9052D '9052'"), std::string::npos)
      << plant.output();
  EXPECT_EQ(plant.run({"show", "port", "5", "--ascii"}), 1);
}

TEST(Scan, ShowsTheStoredAddressInInitMode) {
  Plant plant({"EX9043D-M@2A,init=on,baud=115200"});
  EXPECT_EQ(plant.run({"scan", "port", "--addresses", "0"}), 0);
  EXPECT_EQ(lines_of(plant.output()).size(), 1U) << plant.output();
  EXPECT_NE(plant.output().find("INIT* is tied to GND; stored address 42"), std::string::npos)
      << plant.output();
}

TEST(Scan, ShowsABarInATerminal) {
  Plant plant({"EX9043D@02"});
  Environment environment = plant.environment();
  environment.error_is_terminal = true;
  Options options;
  options.addresses = "2";
  options.speaks = Speaks::Ascii;
  options.line.baud = 9600;
  options.places = {{"baud", ""}, {"format", ""}};
  EXPECT_TRUE(scan_line(environment, {"port"}, options));
  const std::string half(20, '#');
  EXPECT_EQ(plant.error(), "\rscan [" + std::string(2 * half.size(), ' ') + "] 0 %\r\033[K\rscan [" + half +
                               std::string(half.size(), ' ') + "] 50 %\rscan [" + half + half + "] 100 %\n");
}

TEST(Scan, PrintsJson) {
  Plant plant({"EX9042D-M@01", "EX9055D@04,checksum=on"});
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "1-4", "--json"}),
            0);
  EXPECT_EQ(lines_of(plant.output()),
            (Lines{R"({"address":1,"protocol":"modbus","baud":9600,"format":"8N1","model":"EX9042D-M",)"
                   R"("name":"9042M","version":"D01.00","serial-number":"0D000001","last-reset":"power-on"})",
                   R"({"address":4,"protocol":"ascii","baud":9600,"format":"8N1","checksum":true,)"
                   R"("model":"EX9055D","name":"9055","version":"D01.00","serial-number":"0D000002",)"
                   R"("last-reset":"power-on"})"}));
  Plant others({"EX9043D-M@2A,init=on", "EX9052D@07", "EX9042D@07,name=PUMP"});
  EXPECT_EQ(others.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "0-7", "--ascii",
                        "--json"}),
            0);
  EXPECT_EQ(
      lines_of(others.output()),
      (Lines{
          R"({"address":0,"protocol":"ascii","baud":9600,"format":"8N1","checksum":false,)"
          R"("model":"EX9043D-M","name":"9043M","version":"D01.00","serial-number":"0D000001",)"
          R"("last-reset":"power-on","stored-address":42})",
          R"({"address":7,"protocol":"ascii","baud":9600,"format":"8N1","checksum":false,"garbled":true})"}));
}

/// EX9000_MODULES: how many; up to 247.
TEST(Scan, FindsManyModulesAndGivesDuplicatesTheirOwnAddress) {
  const char* const wanted = std::getenv("EX9000_MODULES");
  const unsigned count = wanted == nullptr ? 60 : static_cast<unsigned>(std::strtoul(wanted, nullptr, 10));
  std::vector<std::string> modules;
  for (unsigned i = 0; i < count; ++i) {
    modules.push_back("EX9052D-M@" + sim::hex_byte_text(i < 4 ? 1 : i + 1) + ",baud=115200");
  }
  Plant plant(modules);
  const std::vector<std::string> scan{"scan", "port", "--fast", "--baud", "115200", "--format", "8N1"};
  EXPECT_EQ(plant.run(scan), 0);
  EXPECT_EQ(lines_of(plant.output()).size(), count);
  EXPECT_NE(plant.error().find("4 modules have the address 1"), std::string::npos) << plant.error();
  for (unsigned i = 1; i < 4; ++i) {
    EXPECT_EQ(plant.run({"address", "port", sim::hex_long_text(0x0D00'0001 + i), std::to_string(i + 1),
                         "--baud", "115200"}),
              0)
        << plant.error();
  }
  EXPECT_EQ(plant.run(scan), 0);
  EXPECT_EQ(lines_of(plant.output()).size(), count);
  EXPECT_EQ(plant.error().find("modules have the address"), std::string::npos) << plant.error();
}

TEST(Scan, IsNotDeceivedByNoise) {
  Plant plant({"EX9052D-M@01", "EX9052D-M@02", "EX9052D-M@03"});
  plant.act("fault bit-errors 0.0005");
  EXPECT_EQ(plant.run({"scan", "port", "--fast", "--baud", "9600", "--format", "8N1"}), 0);
  for (const char* number : {"0D000001", "0D000002", "0D000003"}) {
    EXPECT_NE(plant.output().find(number), std::string::npos) << plant.output();
  }
}

/// It has its own mode, whatever --baud says.
TEST(Scan, NamesNoModeOfAGateway) {
  Plant plant({"EX9052D-M@01"});
  EXPECT_EQ(plant.run({"scan", "tcp:host:1", "--fast"}), 0);
  EXPECT_EQ(plant.output(), "1 (01)  modbus  EX9052D-M '9052M'  D01.00  0D000001  last reset: power-on\n");
  EXPECT_EQ(plant.run({"scan", "tcp:host:1", "--fast", "--json"}), 0);
  EXPECT_EQ(plant.output().find("baud"), std::string::npos) << plant.output();
  EXPECT_EQ(plant.run({"show", "tcp:host:1", "1"}), 0);
  EXPECT_NE(plant.output().find(", Modbus\n"), std::string::npos) << plant.output();
}

TEST(Scan, RefusesWhatExcludesEachOther) {
  Plant plant({"EX9052D-M@01"});
  for (const std::vector<std::string>& words : {std::vector<std::string>{"scan", "port", "--fast", "--ascii"},
                                                {"scan", "modbus-tcp:host", "--fast"},
                                                {"scan", "modbus-tcp:host", "--ascii"},
                                                {"show", "port", "1", "--ascii", "--modbus"},
                                                {"scan", "port", "--baud", ""}}) {
    EXPECT_EQ(plant.run(words), 2) << words.back();
  }
}

/// Modules in ASCII with one address: their bytes merge into any text.
TEST(Scan, SurvivesWhatCollisionsLookLike) {
  Plant plant({"EX9042D@02", "EX9055D@02", "EX9052D-M@05", "EX9042D-M@06", "EX9043D@02"});
  plant.act("fault echo 5ms");
  EXPECT_EQ(plant.run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "0-7"}), 0)
      << plant.error();
  EXPECT_EQ(plant.output().find_first_of(std::string("\0\1\2\3\4", 5)), std::string::npos);
}

/// The replies to the first probes of the new address are lost.
TEST(Scan, AddressFindsAModuleWhoseReplyIsLost) {
  Plant plant({"EX9052D-M@01", "EX9042D-M@02"});
  plant.act("2 fault lost-reply for 900ms");
  EXPECT_EQ(plant.run({"address", "port", "0D000001", "2"}), 2) << plant.output();
}

TEST(Scan, SaysThatNobodyReplies) {
  Plant plant({"EX9052D-M@01"});
  plant.act("1 power off");
  EXPECT_EQ(plant.run({"scan", "port", "--fast"}), 1);
  EXPECT_NE(
      plant.error().find("no module replies; check the supply and the wires A and B, or leave out --fast\n"),
      std::string::npos);
}

TEST(Scan, ASecondModuleCannotGetAnAddressInUse) {
  Plant plant({"EX9052D-M@01", "EX9052D-M@02"});
  EXPECT_EQ(plant.run({"address", "port", "0D000001", "2"}), 2);
  EXPECT_NE(plant.error().find("2: another module has this address"), std::string::npos) << plant.error();
  EXPECT_EQ(plant.run({"address", "port", "0D000001", "3"}), 0);
  EXPECT_EQ(plant.output(), "0D000001: address 1 -> 3, in force now\n");
  EXPECT_EQ(plant.run({"address", "port", "1", "3"}), 2);
  EXPECT_EQ(plant.run({"address", "port", "0D000001", "0D000002"}), 2);
  EXPECT_EQ(plant.run({"scan", "port", "--addresses", "9-2"}), 2);
}

}  // namespace
}  // namespace ex9000::utility
