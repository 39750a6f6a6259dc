// Tests the command line of ex9000-sim: the modules and the options of a run.
#include "sim/app/main/arguments.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "tests/sim/app/main/parsed_arguments.hpp"

namespace ex9000::sim {
namespace {

Setup all_accepted(const std::vector<const char*>& words) {
  const Parsed parsed = parse(words);
  EXPECT_TRUE(parsed.setup) << parsed.error;
  EXPECT_EQ(parsed.exit_status, 0);
  EXPECT_EQ(parsed.output, "");
  EXPECT_EQ(parsed.error, "");
  Setup none;
  none.lines.emplace_back();
  return parsed.setup.value_or(none);
}

/// Parses words that describe a single line, and returns that line.
LineSetup accepted(const std::vector<const char*>& words) {
  const auto setup = all_accepted(words);
  EXPECT_EQ(setup.lines.size(), 1U);
  return setup.lines[0];
}

PortSetup port(const std::string& text) {
  const LineSetup line = accepted({"EX9042D-M", "--port", text.c_str()});
  EXPECT_EQ(line.ports.size(), 1U) << text;
  return line.ports.empty() ? PortSetup() : line.ports[0];
}

TEST(Arguments, OneModuleIsEnough) {
  const LineSetup line = accepted({"EX9042D-M"});
  ASSERT_EQ(line.modules.size(), 1U);
  ASSERT_EQ(line.ports.size(), 1U);
  EXPECT_EQ(line.ports[0].kind, PortSetup::Kind::Pty);
  EXPECT_EQ(line.ports[0].path, "ex9000.tty");
  const auto setup = all_accepted({"EX9042D-M"});
  EXPECT_FALSE(setup.log || setup.control || setup.panel || setup.capture);
  EXPECT_EQ(setup.speed.factor, 1.0);
  EXPECT_EQ(setup.seed, 1U);
}

TEST(Arguments, ModulesKeepTheirOrderAndOptionsMayComeBetweenThem) {
  const LineSetup line = accepted({"--log", "EX9042D-M@01", "--baud", "1200", "EX9052D-M@02,edge=rising",
                                   "9068d-m@0A,protocol=ascii", "--strict-gaps"});
  ASSERT_EQ(line.modules.size(), 3U);
  EXPECT_EQ(line.modules[0].settings.address, 0x01);
  EXPECT_EQ(line.modules[1].settings.format, 0x80);
  EXPECT_EQ(line.modules[2].settings.address, 0x0A);
  EXPECT_EQ(line.modules[2].settings.protocol, Protocol::Ascii);
  EXPECT_TRUE(line.strict_gaps);
  EXPECT_EQ(line.baud, 1200U);
}

TEST(Arguments, TheLogFormatIsTextOrJson) {
  EXPECT_EQ(all_accepted({"EX9042D", "--log"}).log, LogFormat::Text);
  EXPECT_EQ(all_accepted({"EX9042D", "--log", "text"}).log, LogFormat::Text);
  EXPECT_EQ(all_accepted({"EX9042D", "--log", "json"}).log, LogFormat::Json);
  EXPECT_EQ(all_accepted({"EX9042D", "--log=json"}).log, LogFormat::Json);
  EXPECT_EQ(all_accepted({"EX9042D", "--log", "--strict-gaps"}).log, LogFormat::Text);
  EXPECT_EQ(accepted({"--log", "json", "EX9042D"}).modules.size(), 1U);
  EXPECT_EQ(accepted({"--log", "EX9042D", "EX9052D@02"}).modules.size(), 2U);
  expect_error({"EX9042D", "--log=xml"}, "--log: 'xml'", "expected text, json, on or off");
  expect_error({"EX9042D", "--log="}, "--log", "--help");
}

TEST(Arguments, PanelTakesAnOptionalPort) {
  EXPECT_FALSE(all_accepted({"--panel", "EX9042D"}).panel->port);
  EXPECT_FALSE(all_accepted({"EX9042D", "--panel"}).panel->port);
  EXPECT_EQ(all_accepted({"--panel", "8080", "EX9042D"}).panel->port, 8080);
  EXPECT_EQ(all_accepted({"EX9042D", "--panel=0"}).panel->port, 0);
  EXPECT_EQ(accepted({"--panel", "9042D"}).modules.size(), 1U);
  expect_error({"EX9042D", "--panel=65536"}, "--panel: '65536'", "0 to 65535");
  expect_error({"EX9042D", "--panel=web"}, "--panel: 'web'", "0 to 65535");
  expect_error({"EX9042D", "--panel="}, "--panel", "--help");
}

/// `sim/run` passes --panel and --log, and then the arguments of its user, which may contain these options
/// again.
TEST(Arguments, OnlyTheLastPanelAndLogOptionsApply) {
  EXPECT_EQ(all_accepted({"EX9042D", "--panel", "--log", "--panel", "8080"}).panel->port, 8080);
  EXPECT_EQ(all_accepted({"EX9042D", "--panel", "--log", "--log", "json"}).log, LogFormat::Json);
  const auto without = all_accepted({"EX9042D", "--panel", "--log", "--panel", "off", "--log", "off"});
  EXPECT_FALSE(without.panel);
  EXPECT_FALSE(without.log);
  expect_error({"EX9042D", "--baud", "1200", "--baud", "1200"}, "--baud: is given twice",
               "leave out one of them");
}

// --- ports ---

TEST(Arguments, ALineMayHaveSeveralPorts) {
  const LineSetup line = accepted(
      {"EX9042D", "--port", "tcp:5020", "--port=pty:a", "--port", "tcp:0", "--port", "modbus-tcp:502"});
  ASSERT_EQ(line.ports.size(), 4U);
  EXPECT_EQ(line.ports[1].path, "a");
  EXPECT_EQ(line.ports[3].kind, PortSetup::Kind::ModbusTcp);
  EXPECT_EQ(line.ports[3].address.port, 502);
}

TEST(Arguments, APortHasOptions) {
  EXPECT_EQ(port("pty:a,access=660:root").access->mode, 0660U);
  EXPECT_EQ(port("pty:a,access=660:root").access->group, 0U);
  EXPECT_FALSE(port("pty:a,access=622").access->group);
  EXPECT_EQ(port("pty:a,access=600:4711").access->group, 4711U);
  EXPECT_EQ(port("modbus-tcp:0").timeout, std::chrono::milliseconds(200));
  EXPECT_EQ(port("modbus-tcp:0,timeout=1s,wait").timeout, std::chrono::seconds(1));
  EXPECT_TRUE(port("modbus-tcp:0,timeout=1s,wait").wait);
  EXPECT_TRUE(port("serial:/dev/ttyUSB0,echo").echo);
  EXPECT_FALSE(port("serial:/dev/ttyUSB0").echo);
}

TEST(Arguments, AWrongPortIsRefused) {
  const std::string kinds = "expected pty:LINK, tcp:[HOST:]PORT, ";
  for (const auto& [text, wrong, mend] : std::vector<std::array<std::string, 3>>{
           {"", "''", kinds},
           {"5020", "'5020'", kinds},
           {"udp:5020", "'udp:5020'", kinds},
           {"tcp", "'tcp'", kinds},
           {"pty:", "pty:: the path is missing", ""},
           {"pty:a,echo", "echo: unknown option", "expected access=MODE[:GROUP] or wait"},
           {"tcp:0,access=660", "access=660: unknown option", "expected wait"},
           {"serial:a,wait", "wait: unknown option", "expected echo"},
           {"serial:a,echo=on", "echo=on: expected echo", ""},
           {"modbus-tcp:0,timeout", "timeout: expected timeout=TIME", ""},
           {"modbus-tcp:0,timeout=1", "'1': expected a duration", ""},
           {"tcp:0,wait,wait", "wait: is given twice", "leave out one of them"},
           {"pty:a,access=660:no-such-group", "no group 'no-such-group'", "/etc/group"},
           {"pty:a,access=660:", "no group ''", "/etc/group"},
       }) {
    expect_error({"EX9042D", "--port", text.c_str()}, "--port: ", wrong);
    expect_error({"EX9042D", "--port", text.c_str()}, wrong, mend);
  }
  for (const char* wrong : {"66", "6600", "060", "0660", "460", "670", "888", ":root", "rw"}) {
    const std::string text = "pty:a,access=" + std::string(wrong);
    expect_error({"EX9042D", "--port", text.c_str()}, "--port: ", "expected MODE[:GROUP]");
  }
}

TEST(Arguments, ATcpAddressIsHostAndPortOrAPortAlone) {
  const auto address = [](const std::string& text) {
    const TcpAddress address = port("tcp:" + text).address;
    return address.host + " " + std::to_string(address.port);
  };
  EXPECT_EQ(address("5020"), "127.0.0.1 5020");
  EXPECT_EQ(address(":5020"), "127.0.0.1 5020");
  EXPECT_EQ(address("0.0.0.0:0"), "0.0.0.0 0");
  EXPECT_EQ(address("localhost:65535"), "127.0.0.1 65535");
  EXPECT_EQ(address("[::1]:5020"), "::1 5020");
  for (const char* wrong :
       {"", ":", "localhost", "localhost:", ":65536", "::1:5020", "a:-1", "5020x", "1:2:3"}) {
    const std::string text = "tcp:" + std::string(wrong);
    expect_error({"EX9042D", "--port", text.c_str()}, "--port: tcp:", "HOST:PORT");
  }
  for (const char* name : {"simulator.local:5020", "256.0.0.1:5020", "[::g]:5020"}) {
    const std::string text = "modbus-tcp:" + std::string(name);
    expect_error({"EX9042D", "--port", text.c_str()},
                 "--port: ", "expected a numeric address or localhost as HOST");
  }
}

// --- values that cannot be combined ---

TEST(Arguments, ValuesThatCannotBeCombinedAreRefused) {
  const std::string one = "leave out one of them";
  for (const auto& [words, wrong, mend] :
       std::vector<std::tuple<std::vector<const char*>, std::string, std::string>>{
           {{"--port", "serial:a", "--port", "tcp:5020"},
            "--port: tcp:5020: cannot be combined with serial:a",
            one},
           {{"--port", "serial:a", "--port", "serial:b"},
            "--port: serial:b: cannot be combined with serial:a",
            one},
           {{"--port", "serial:a", "--timing", "instant"},
            "--timing: instant cannot be combined with serial:a",
            one},
           {{"--port", "serial:a", "--speed", "2"}, "--port: serial:a: requires speed 1", one},
           {{"--port", "serial:a", "--speed", "step", "--control", "c"}, "serial:a: requires speed 1", one},
           {{"--port", "tcp:0", "--speed", "max", "--for", "1s"},
            "--port: tcp:0: cannot be combined with speed max",
            one},
           {{"--port", "tcp:0,wait", "--speed", "step", "--control", "c"},
            "--port: tcp:0: wait cannot be combined",
            one},
           {{"--port", "tcp:502", "--port", "modbus-tcp:localhost:502"},
            "--port: modbus-tcp:localhost:502: two ports",
            "name one for each"},
           {{"--timing", "instant", "--strict-gaps"},
            "--strict-gaps: cannot be combined with timing instant",
            one},
           {{"--speed", "max"}, "--speed: max requires for", "for example 10s"},
           {{"--speed", "max", "--for", "1s", "--panel"},
            "--speed: max cannot be combined with control or panel",
            one},
           {{"--speed", "step"}, "--speed: step requires control", ""},
           {{"--speed", "step", "--control", "c", "--panel"},
            "--speed: step cannot be combined with panel",
            one},
           {{"--port", "pty:b", "--control", "./b"}, "--control: ./b: is already used", "name another path"},
       }) {
    std::vector<const char*> all{"EX9042D"};
    all.insert(all.end(), words.begin(), words.end());
    expect_error(all, wrong, mend);
  }
  EXPECT_TRUE(all_accepted({"EX9042D", "--speed", "max", "--for", "1s"}).speed.max());
  EXPECT_TRUE(all_accepted({"EX9042D", "--speed", "max", "--for", "1s"}).lines[0].ports.empty());
  EXPECT_EQ(all_accepted({"EX9042D", "--speed", "step", "--control", "c"}).lines[0].ports.size(), 1U);
}

TEST(Arguments, AnEepromFileHasOneUse) {
  const std::string why = "eeprom=: a: is already used; name another path";
  expect_error({"EX9042D,eeprom=a", "EX9052D@02,eeprom=a"}, why, "");
  expect_error({"EX9042D,eeprom=a", "--control", "a"}, "--control: a: is already used", "");
  expect_error({"EX9042D,eeprom=a", "--port", "pty:x/../a"}, why, "");
  EXPECT_EQ(accepted({"EX9042D,eeprom=a", "EX9052D@02,eeprom=b"}).modules[1].eeprom, "b");
}

// --- wrong values ---

TEST(Arguments, AWrongModuleIsRefused) {
  expect_error({"EX9999"}, "EX9999", "--models");
  expect_error({"EX9042D", "EX9052D@GG"}, "EX9052D@GG", "hex digits");
  expect_error({""}, "empty argument", "--models");
  expect_error({"EX9042D,eeprom="}, "eeprom=: is empty", "name a path");
}

TEST(Arguments, AWrongValueIsRefused) {
  for (const auto& [option, value, mend] : std::vector<std::array<const char*, 3>>{
           {"--baud", "300", "9600"},
           {"--seed", "18446744073709551616", "a whole number from 0 to 18446744073709551615"},
           {"--speed", "0", "from 0.001 to 1000, max or step"},
           {"--speed", "0.00099", "from 0.001 to 1000, max or step"},
           {"--speed", "1000.1", "from 0.001 to 1000, max or step"},
           {"--speed", "nan", "from 0.001 to 1000, max or step"},
           {"--speed", "", "from 0.001 to 1000, max or step"},
           {"--for", "1", "a duration"},
           {"--name", "a b", "one word"},
       }) {
    expect_error({"EX9042D", option, value}, std::string(option) + ": '" + value + "'", mend);
  }
  expect_error({"EX9042D", "--fault", "gone\nat\nnoon"}, "--fault: gone at noon: 'noon'", "12.5s");
  expect_error({"EX9042D", "--fault", " "}, "--fault: ends too early", "expected one of bit-errors");
  expect_error({"EX9042D", "--control", ""}, "--control: is empty", "name a path");
  expect_error({"EX9042D", "--capture", ""}, "--capture: is empty", "name a path");
  expect_error({"EX9042D", "--verbose"}, "--verbose", "--help");
}

TEST(Arguments, AnOptionRequiresItsValue) {
  for (const char* option : {"--port", "--baud", "--control", "--capture", "--fault"}) {
    expect_error({"EX9042D", option}, option, "--help");
    expect_error({"EX9042D", option, "--log"}, std::string(option) + ": the value is missing before --log",
                 "");
  }
  expect_error({"EX9042D", "--port", "--for", "0.2s"}, "--port: ", "before --for; expected --port PORT");
  expect_error({"describe", "EX9042D", "--format", "--address", "1"},
               "--format: ", "the value is missing before --address");
  EXPECT_EQ(all_accepted({"EX9042D", "--control=--odd"}).control, "--odd");
}

// bus_file_test.cpp tests the values of the settings that a bus file has too.
TEST(Arguments, ValidValuesAreTaken) {
  EXPECT_EQ(accepted({"EX9042D", "--baud", "115200"}).baud, 115200U);
  EXPECT_EQ(accepted({"EX9042D", "--format", "8E1"}).format, LineFormat::k8E1);
  EXPECT_TRUE(accepted({"EX9042D", "--timing", "instant"}).instant);
  EXPECT_EQ(accepted({"EX9042D", "--name", "hall"}).name, "hall");
  EXPECT_EQ(all_accepted({"EX9042D", "--capture", "line.pcapng"}).capture, "line.pcapng");
  for (const auto& [text, speed] :
       {std::pair("0.001", 0.001), std::pair("10", 10.0), std::pair("1e3", 1000.0)}) {
    EXPECT_EQ(all_accepted({"EX9042D", "--speed", text}).speed.factor, speed);
  }
}

TEST(Arguments, AModuleMayHaveInputsAndFaultsAndALineMayHaveFaults) {
  const LineSetup line = accepted({"EX9042D,fault=lost-reply every 10th reply",
                                   "EX9052D@02,input=0 square 100ms,input=7 key at 2s for 300ms", "--fault",
                                   "bit-errors 1e-4", "--fault", "gone at 12.5s"});
  ASSERT_EQ(line.modules[0].faults.size(), 1U);
  EXPECT_EQ(line.modules[0].faults[0].text, "lost-reply every 10th reply");
  ASSERT_EQ(line.modules[1].inputs.size(), 2U);
  EXPECT_EQ(line.modules[1].inputs[1].channel, 7U);
  ASSERT_EQ(line.faults.size(), 2U);
  EXPECT_EQ(line.faults[0].text, "bit-errors 1e-4");
  EXPECT_EQ(line.faults[1].text, "gone at 12.5s");
  expect_error({"EX9052D,fault=bit-errors 0.1"}, "bit-errors 0.1: concerns the line",
               "add it as a fault of the line");
  expect_error({"EX9052D,input=8 square 1s"}, "input=: 8 square 1s", "0 to 7");
}

}  // namespace
}  // namespace ex9000::sim
