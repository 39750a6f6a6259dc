// Tests bus files, which describe lines and their modules.
#include "sim/app/setup_from_bus_file/bus_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/app/main/arguments.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

Setup parsed(const std::string& text) { return parse_bus_file("bus.json", text); }

std::string why_not(const std::string& text) {
  return refusal([&] { parsed(text); });
}

/// Returns a bus file with one line, which has one module and the JSON members `members`. The members begin
/// in the second text line of the file.
std::string line_with(const std::string& members) {
  return "{\"lines\": [{\"modules\": [{\"model\": \"EX9052D-M\"}],\n" + members + "}]}";
}
std::string module_with(const std::string& members) {
  return "{\"lines\": [{\"modules\": [{\"model\": \"EX9052D-M\",\n" + members + "}]}]}";
}

LineSetup line_of(const std::string& members) { return parsed(line_with(members)).lines.at(0); }
ModuleSpec module_of(const std::string& members) {
  return parsed(module_with(members)).lines.at(0).modules.at(0);
}

// --- valid files ---

TEST(BusFile, TheExampleGivesTheExpectedSetup) {
  const auto setup = parsed(example_bus_file());
  EXPECT_EQ(setup.control, "ex9000.ctl");
  EXPECT_EQ(setup.seed, 1U);
  EXPECT_FALSE(setup.log);
  ASSERT_EQ(setup.lines.size(), 2U);

  const LineSetup& hall = setup.lines[0];
  EXPECT_EQ(hall.name, "hall");
  EXPECT_EQ(hall.pty, "hall.tty");
  EXPECT_FALSE(hall.tcp);
  EXPECT_EQ(hall.baud, 9600U);
  EXPECT_FALSE(hall.instant);
  ASSERT_EQ(hall.modules.size(), 2U);
  EXPECT_EQ(hall.modules[0].model->designation, "EX9042D-M");
  EXPECT_EQ(hall.modules[0].settings.address, 1);
  EXPECT_EQ(hall.modules[0].eeprom, "hall-01.bin");
  EXPECT_EQ(hall.modules[1].model->designation, "EX9052D-M");
  EXPECT_EQ(hall.modules[1].settings.address, 2);
  EXPECT_EQ(hall.modules[1].settings.format, 0x80);
  ASSERT_EQ(hall.modules[1].inputs.size(), 2U);
  EXPECT_EQ(hall.modules[1].inputs[0].kind, InputProgram::Kind::Square);
  EXPECT_EQ(hall.modules[1].inputs[0].time, 100ms);
  EXPECT_EQ(hall.modules[1].inputs[1].channel, 3U);
  EXPECT_EQ(hall.modules[1].inputs[1].bounce, 5ms);
  ASSERT_EQ(hall.faults.size(), 4U);
  EXPECT_EQ(hall.faults[0].text, "lost-reply every 10th reply");
  EXPECT_EQ(hall.faults[0].module, 0U);
  EXPECT_EQ(hall.faults[1].text, "power-cut after 3 writes");
  EXPECT_EQ(hall.faults[1].module, 0U);
  EXPECT_EQ(hall.faults[2].text, "bit-errors 1e-5");
  EXPECT_FALSE(hall.faults[2].module);
  EXPECT_EQ(hall.faults[3].text, "foreign-traffic 0501000000083C48 every 30s");

  const LineSetup& yard = setup.lines[1];
  EXPECT_EQ(yard.name, "yard");
  EXPECT_FALSE(yard.pty);
  EXPECT_EQ(yard.tcp.value_or(TcpAddress()).port, 5020);
  EXPECT_TRUE(yard.instant);
  EXPECT_FALSE(yard.baud);
  EXPECT_FALSE(yard.format);
  ASSERT_EQ(yard.modules.size(), 2U);
  EXPECT_EQ(yard.modules[0].settings.protocol, Protocol::Ascii);
  EXPECT_EQ(yard.modules[0].settings.format, 0x40);
  EXPECT_EQ(yard.modules[0].settings.name, Name("PUMPS"));
  EXPECT_EQ(yard.modules[1].model->designation, "EX9055D");
  EXPECT_EQ(yard.modules[1].settings.address, 0x0B);
  EXPECT_FALSE(yard.modules[1].init_asserted);
  ASSERT_EQ(yard.faults.size(), 2U);
  EXPECT_EQ(yard.faults[0].module, 0U);
  EXPECT_EQ(yard.faults[1].text, "gone at 1h for 2min");
}

TEST(BusFile, PanelAcceptsTrueFalseAndAPort) {
  const auto panel = [](const std::string& value) {
    return parsed(R"({"panel": )" + value + R"(, "lines": [{"modules": [{"model": "EX9042D"}]}]})").panel;
  };
  EXPECT_FALSE(panel("false"));
  ASSERT_TRUE(panel("true"));
  EXPECT_FALSE(panel("true")->port);
  EXPECT_EQ(panel("8080")->port, 8080);
  EXPECT_EQ(panel("\"0\"")->port, 0);
}

TEST(BusFile, WatchIsTrueOrFalse) {
  const auto watch = [](const std::string& value) {
    return parsed(R"({"watch": )" + value + R"(, "lines": [{"modules": [{"model": "EX9042D"}]}]})").watch;
  };
  EXPECT_FALSE(watch("false"));
  EXPECT_TRUE(watch("true"));
}

TEST(BusFile, OneLineWithOneModuleIsEnough) {
  const auto setup = parsed(R"({"lines": [{"modules": [{"model": "ex9042d-m"}]}]})");
  ASSERT_EQ(setup.lines.size(), 1U);
  EXPECT_EQ(setup.lines[0].modules[0].model->designation, "EX9042D-M");
  EXPECT_FALSE(setup.control);
  EXPECT_FALSE(setup.log);
  EXPECT_EQ(setup.seed, 1U);
}

TEST(BusFile, LinesWithoutANameAreNumbered) {
  const auto setup = parsed(R"({"lines": [{"modules": [{"model": "EX9042D"}], "tcp": 0},
    {"modules": [{"model": "EX9042D"}], "tcp": 0, "name": "yard"},
    {"modules": [{"model": "EX9042D"}], "tcp": 0}]})");
  EXPECT_EQ(setup.lines[0].name, "line1");
  EXPECT_EQ(setup.lines[1].name, "yard");
  EXPECT_EQ(setup.lines[2].name, "line3");
}

TEST(BusFile, ALineAcceptsOptionsOfTheCommandLineAsKeys) {
  EXPECT_EQ(line_of("\"tcp\": 5020").tcp.value_or(TcpAddress()).host, "127.0.0.1");
  EXPECT_EQ(line_of("\"tcp\": \"[::1]:5020\"").tcp.value_or(TcpAddress()).host, "::1");
  EXPECT_EQ(line_of("\"modbus-tcp\": 502").modbus_tcp.value_or(TcpAddress()).port, 502);
  EXPECT_EQ(line_of("\"modbus-tcp\": \"localhost:502\"").modbus_tcp.value_or(TcpAddress()).host, "127.0.0.1");
  EXPECT_EQ(line_of("\"pty\": \"a\"").pty, "a");
  EXPECT_EQ(line_of("\"serial\": \"/dev/ttyUSB0\", \"echo\": true").serial, "/dev/ttyUSB0");
  EXPECT_TRUE(line_of("\"serial\": \"/dev/ttyUSB0\", \"echo\": true").echo);
  EXPECT_EQ(line_of("\"pty\": \"a\", \"baud\": 19200").baud, 19200U);
  EXPECT_EQ(line_of("\"pty\": \"a\", \"format\": \"8E1\"").format, LineFormat::k8E1);
  EXPECT_EQ(line_of("\"pty\": \"a\", \"baud\": \"19200\"").baud, 19200U);
  EXPECT_FALSE(line_of("\"pty\": \"a\", \"line\": \"paced\"").instant);
  EXPECT_TRUE(line_of("\"pty\": \"a\", \"line\": \"instant\"").instant);
  EXPECT_TRUE(line_of("\"pty\": \"a\", \"strict-gaps\": true").strict_gaps);
  EXPECT_EQ(line_of("\"pty\": \"a\", \"format\": \"8o1\"").format, LineFormat::k8O1);
  EXPECT_EQ(line_of("\"pty\": \"a\", \"pty-access\": \"660\"").pty_access->mode, 0660U);
  EXPECT_EQ(line_of("\"modbus-tcp\": 0, \"modbus-timeout\": \"1s\"").modbus_timeout, std::chrono::seconds(1));
}

TEST(BusFile, AModuleAcceptsTheKeysOfTheCommandLine) {
  EXPECT_EQ(module_of("\"address\": \"F\"").settings.address, 0x0F);
  EXPECT_EQ(module_of("\"protocol\": \"ascii\"").settings.protocol, Protocol::Ascii);
  EXPECT_EQ(module_of("\"baud\": 115200").settings.baud_code, 0x0A);
  EXPECT_EQ(module_of("\"format\": \"8O1\"").settings.baud_code, 0xC6);
  EXPECT_EQ(module_of("\"checksum\": true").settings.format, 0x40);
  EXPECT_EQ(module_of("\"checksum\": \"on\"").settings.format, 0x40);
  EXPECT_EQ(module_of("\"checksum\": false").settings.format, 0x00);
  EXPECT_EQ(module_of("\"edge\": \"rising\"").settings.format, 0x80);
  // On a command line, a comma would end the name.
  EXPECT_EQ(module_of("\"name\": \"a b,c\"").settings.name, Name("a b,c"));
  EXPECT_TRUE(module_of("\"init\": true").init_asserted);
  EXPECT_EQ(module_of("\"eeprom\": \"a,b.bin\"").eeprom, "a,b.bin");
}

TEST(BusFile, KeysMayComeInAnyOrder) {
  const auto setup = parsed(R"({"seed": 7, "log": true, "lines": [{"faults": ["echo 2ms"], "modules": [
    {"faults": ["gone"], "inputs": ["7 square 1s"], "address": "02", "model": "EX9052D"}], "pty": "a"}]})");
  EXPECT_EQ(setup.seed, 7U);
  EXPECT_TRUE(setup.log);
  EXPECT_EQ(setup.lines[0].modules[0].settings.address, 2);
  ASSERT_EQ(setup.lines[0].faults.size(), 2U);
  EXPECT_EQ(setup.lines[0].faults[0].trouble, Trouble::Echo);
  EXPECT_FALSE(setup.lines[0].faults[0].module);
  EXPECT_EQ(setup.lines[0].faults[1].module, 0U);
}

// --- files that the program rejects ---

struct Wrong {
  const char* file;
  const char* why;
};

class WrongBusFile : public testing::TestWithParam<Wrong> {};

TEST_P(WrongBusFile, IsRefusedWithAOneLineMessageThatBeginsWithFileAndLine) {
  const std::string why = why_not(GetParam().file);
  EXPECT_EQ(why.rfind(GetParam().why, 0), 0U) << why;
  EXPECT_EQ(why.find('\n'), std::string::npos) << why;
}

INSTANTIATE_TEST_SUITE_P(
    Json, WrongBusFile,
    testing::Values(
        Wrong{"", "bus.json:1: syntax error"}, Wrong{"{\n\"lines\": [\n}\n", "bus.json:3: syntax error"},
        Wrong{"{\n\"seed\" 1}", "bus.json:2: syntax error"},
        Wrong{"{\"log\": true}\n{}", "bus.json:2: syntax error"},
        Wrong{"{\n\n\"seed\": 1e999}", "bus.json:3: number overflow"},
        Wrong{"{\n\"log\": true,\n\"log\": false}",
              "bus.json:3: 'log' is given twice; leave out one of them"},
        Wrong{"{\n\"lines\": [],\n\"a\": {\"b\": 1},\n\"a.b\": 2}", "bus.json:3: a: unknown key"},
        Wrong{"{\"control\":\n\"a\\u0000b\"}", "bus.json:2: a text contains NUL; leave out \\u0000"},
        Wrong{"[[[[[[[[[[[[[[[[[\n]]]]]]]]]]]]]]]]]",
              "bus.json:1: has too many levels of lists and objects; see 'ex9000-sim --schema'"}));

INSTANTIATE_TEST_SUITE_P(
    Whole, WrongBusFile,
    testing::Values(
        Wrong{"[]", "bus.json:1: expected an object, { }"}, Wrong{"5", "bus.json:1: expected an object, { }"},
        Wrong{"{\n\n}", "bus.json:1: lines: a bus file requires at least one line; 'ex9000-sim --example'"},
        Wrong{"{\n\"lines\": []}",
              "bus.json:2: lines: a bus file requires at least one line; 'ex9000-sim --example'"},
        Wrong{"{\n\"lines\": {}}", "bus.json:2: lines: expected a list, [ ]"},
        Wrong{"{\n\"line\": []}",
              "bus.json:2: line: unknown key; expected one of lines, control, panel, watch, log, capture, "
              "seed"},
        Wrong{"{\n\"log\": 1}", "bus.json:2: log: expected true, false or a text in quotes"},
        Wrong{"{\n\"log\": \"xml\"}", "bus.json:2: log: 'xml': expected text, json or off"},
        Wrong{"{\n\"panel\": 70000}", "bus.json:2: panel: '70000': expected a port from 0 to 65535"},
        Wrong{"{\n\"panel\": []}",
              "bus.json:2: panel: expected a text in quotes, a whole number, true or false"},
        Wrong{"{\n\"watch\": \"yes\"}", "bus.json:2: watch: expected true or false"},
        Wrong{"{\"log\": \"json\",\n\"watch\": true, \"lines\": [{\"modules\": [{\"model\": \"EX9042D\"}]}]}",
              "bus.json:2: watch: cannot be combined with 'log' json, because both write to standard output; "
              "leave out one of them"},
        Wrong{"{\n\"seed\": -1}", "bus.json:2: seed: expected a whole number or a text in quotes"},
        Wrong{"{\n\"seed\": 1.5}", "bus.json:2: seed: expected a whole number or a text in quotes"},
        Wrong{"{\n\"seed\": \"x\"}", "bus.json:2: seed: 'x': expected a whole number"},
        Wrong{"{\n\"control\": 1}", "bus.json:2: control: expected a text in quotes"},
        Wrong{"{\n\"capture\": \"\", \"lines\": [{\"pty\": \"a\", \"modules\": [{\"model\": \"EX9042D\"}]}]}",
              "bus.json:2: capture: is empty; name a path"},
        Wrong{"{\n\"control\": \"\", \"lines\": [{\"pty\": \"a\", \"modules\": [{\"model\": \"EX9042D\"}]}]}",
              "bus.json:2: control: is empty; name a path"}));

INSTANTIATE_TEST_SUITE_P(
    Lines, WrongBusFile,
    testing::Values(
        Wrong{"{\"lines\": [\n5]}", "bus.json:1: lines[0]: expected an object, { }"},
        Wrong{"{\"lines\": [\n{\"pty\": \"a\"}]}",
              "bus.json:2: lines[0].modules: a line requires at least one module, for example {"},
        Wrong{"{\"lines\": [\n{\"pty\": \"a\",\n\"modules\": []}]}",
              "bus.json:3: lines[0].modules: a line requires at least one module"},
        Wrong{"{\"lines\": [{\n\"speed\": 1}]}",
              "bus.json:2: lines[0].speed: unknown key; expected one of name, pty"},
        Wrong{"{\"lines\": [{\n\"baud\": 300}]}",
              "bus.json:2: lines[0].baud: '300': expected a baud rate: 1200"},
        Wrong{"{\"lines\": [{\n\"baud\": true}]}",
              "bus.json:2: lines[0].baud: expected a whole number or a text in quotes"},
        Wrong{"{\"lines\": [{\n\"line\": \"fast\"}]}",
              "bus.json:2: lines[0].line: 'fast': expected instant or paced"},
        Wrong{"{\"lines\": [{\n\"tcp\": \"here\"}]}",
              "bus.json:2: lines[0].tcp: 'here': expected HOST:PORT or a port"},
        Wrong{"{\"lines\": [{\n\"tcp\": 70000}]}",
              "bus.json:2: lines[0].tcp: '70000': expected HOST:PORT or a port"},
        Wrong{"{\"lines\": [{\n\"echo\": \"yes\"}]}", "bus.json:2: lines[0].echo: expected true or false"},
        Wrong{"{\"lines\": [{\n\"faults\": \"gone\"}]}", "bus.json:2: lines[0].faults: expected a list, [ ]"},
        Wrong{"{\"lines\": [{\"faults\": [\"gone\",\n\"gone at\"]}]}",
              "bus.json:2: lines[0].faults[1]: gone at: ends too early; expected a time after 'at'"},
        Wrong{"{\"lines\": [{\"faults\": [\n{}]}]}",
              "bus.json:2: lines[0].faults[0]: expected a text in quotes"}));

INSTANTIATE_TEST_SUITE_P(
    Modules, WrongBusFile,
    testing::Values(Wrong{"{\"lines\": [{\"modules\": [\n{}]}]}",
                          "bus.json:2: lines[0].modules[0].model: is missing; expected a model's name"},
                    Wrong{"{\"lines\": [{\"modules\": [{\n\"model\": 9042}]}]}",
                          "bus.json:2: lines[0].modules[0].model: expected a text in quotes"},
                    Wrong{"{\"lines\": [{\"modules\": [{\n\"model\": \"EX1\"}]}]}",
                          "bus.json:2: lines[0].modules[0].model: 'EX1' is not a model; 'ex9000-sim "
                          "--models' lists all models"}));

TEST(WrongModuleOfABusFile, IsRefusedWithFileLineKeyAndRemedy) {
  for (const auto& [members, why] : std::vector<std::pair<std::string, std::string>>{
           {"\"colour\": \"red\"", "colour: unknown key; expected one of model, address"},
           {"\"address\": 1", "address: expected a text in quotes"},
           {"\"address\": \"100\"", "address: '100': expected one or two hex digits"},
           {"\"protocol\": \"rtu\"", "protocol: 'rtu': expected modbus or ascii"},
           {"\"protocol\": true", "protocol: expected a text in quotes"},
           {"\"baud\": 9601", "baud: '9601': expected a baud rate: 1200"},
           {"\"baud\": true", "baud: expected a whole number or a text in quotes"},
           {"\"format\": \"8N3\"", "format: '8N3': expected a line format: 8N1, 8N2, 8E1 or 8O1"},
           {"\"checksum\": 2", "checksum: expected true, false or a text in quotes"},
           {"\"checksum\": \"2\"", "checksum: '2': expected on or off"},
           {"\"edge\": null", "edge: expected a text in quotes"},
           {"\"edge\": \"up\"", "edge: 'up': expected rising or falling"},
           {"\"name\": 9052", "name: expected a text in quotes"},
           {"\"name\": \"TOOLONG\"",
            "name: 'TOOLONG': expected 1 to 6 printable ASCII characters for the EX9052D-M"},
           {"\"init\": \"yes\"", "init: 'yes': expected on or off"},
           {"\"init\": 1", "init: expected true, false or a text in quotes"},
           {"\"eeprom\": \"\"", "eeprom: is empty; name a path"},
           {"\"inputs\": \"0 square 1s\"", "inputs: expected a list, [ ]"},
           {"\"inputs\": [\"\"]", "inputs[0]: the channel is missing; expected 'CHANNEL square PERIOD'"},
           {"\"inputs\": [\"8 square 1s\"]",
            "inputs[0]: 8 square 1s: the EX9052D-M has no input '8'; it has 0 to 7"},
           {"\"faults\": [\"hang\", \"lost\"]",
            "faults[1]: 'lost' is not a fault; expected one of bit-errors"},
           {"\"faults\": [\"echo 2ms\"]",
            "faults[0]: concerns the line, not a module; move it to the line's faults"},
       }) {
    const std::string refused = why_not(module_with(members));
    EXPECT_EQ(refused.rfind("bus.json:2: lines[0].modules[0]." + why, 0), 0U) << refused;
  }
}

TEST(WrongModuleOfABusFile, AnAddressInvalidForTheProtocolIsRefused) {
  EXPECT_EQ(why_not(module_with("\"address\": \"00\"")),
            "bus.json:1: lines[0].modules[0]: address 00: is not a Modbus address; expected hex 01 to F7, "
            "or the protocol ascii");
}

TEST(WrongLineOfABusFile, InvalidOrConflictingKeysAreRefusedWithTheirPlace) {
  for (const auto& [members, why] : std::vector<std::pair<std::string, std::string>>{
           {"\"pty\": \"\"", "pty: is empty; name a path"},
           {"\"serial\": \"a\", \"pty\": \"b\"",
            "serial: cannot be combined with 'pty', 'tcp' or 'modbus-tcp', because the master is on the "
            "serial "
            "line; leave out 'serial' or the other ports"},
           {"\"tcp\": 0, \"pty-access\": \"660\"",
            "pty-access: requires 'pty'; add 'pty', or leave out 'pty-access'"},
           {"\"pty\": \"a\", \"modbus-timeout\": \"1s\"",
            "modbus-timeout: requires 'modbus-tcp'; add 'modbus-tcp', or leave out 'modbus-timeout'"},
           {"\"pty\": \"a\", \"echo\": true", "echo: requires 'serial'; add 'serial', or leave out 'echo'"},
           {"\"serial\": \"a\", \"line\": \"instant\"",
            "line: instant cannot be combined with 'serial', because bytes on a serial line take time; leave "
            "out one of them"},
           {"\"pty\": \"a\", \"line\": \"instant\", \"strict-gaps\": true",
            "strict-gaps: cannot be combined with 'line' instant"},
           {"\"pty\": \"a\", \"name\": \"the hall\"",
            "name: 'the hall': expected one word of ASCII characters"},
           {"\"pty\": \"a\", \"name\": \"the {hall}\"", "name: 'the {hall}': expected one word"},
       }) {
    const std::string refused = why_not(line_with(members));
    EXPECT_EQ(refused.rfind("bus.json:2: lines[0]." + why, 0), 0U) << refused;
  }
}

std::string two_lines(const std::string& first, const std::string& second) {
  return "{\"lines\": [\n{\"modules\": [{\"model\": \"EX9042D\"}],\n" + first +
         "},\n{\"modules\": [{\"model\": \"EX9042D\"}],\n" + second + "}]}";
}

TEST(WrongLinesOfABusFile, TwoLinesCannotShareAPortOrAName) {
  EXPECT_EQ(why_not(two_lines("\"pty\": \"a\"", "\"pty\": \"a\"")),
            "bus.json:5: lines[1].pty: a: two lines cannot share a port; name one for each");
  EXPECT_EQ(why_not(two_lines("\"pty\": \"a\"", "\"pty\": \"./a\"")),
            "bus.json:5: lines[1].pty: ./a: two lines cannot share a port; name one for each");
  EXPECT_EQ(why_not(two_lines("\"serial\": \"a\"", "\"serial\": \"a\"")),
            "bus.json:5: lines[1].serial: a: two lines cannot share a port; name one for each");
  EXPECT_EQ(why_not(two_lines("\"tcp\": 5020", "\"tcp\": \"127.0.0.1:5020\"")),
            "bus.json:5: lines[1].tcp: 127.0.0.1:5020: two ports cannot share an address; name one for each");
  EXPECT_EQ(why_not(two_lines("\"tcp\": 5020", "\"modbus-tcp\": 5020")),
            "bus.json:5: lines[1].modbus-tcp: 127.0.0.1:5020: two ports cannot share an address; name one "
            "for each");
  EXPECT_EQ(why_not(two_lines("\"tcp\": 0, \"name\": \"a\"", "\"tcp\": 0, \"name\": \"a\"")),
            "bus.json:5: lines[1].name: a: two lines have this name; give each line a different name");
  EXPECT_EQ(parsed(two_lines("\"tcp\": 0", "\"tcp\": 0")).lines.size(), 2U);
}

TEST(WrongLinesOfABusFile, TwoModulesCannotShareAnEeprom) {
  const auto with = [](const std::string& eeprom) {
    return "{\"lines\": [{\"pty\": \"a\", \"modules\": [{\"model\": \"EX9042D\", \"eeprom\": \"x\"}]},\n"
           "{\"pty\": \"b\", \"modules\": [{\"model\": \"EX9042D\", \"eeprom\": \"" +
           eeprom + "\"}]}]}";
  };
  EXPECT_EQ(why_not(with("x")),
            "bus.json:2: lines[1].modules[0].eeprom: x: two modules cannot share a file; name one for each");
  EXPECT_EQ(parsed(with("y")).lines.size(), 2U);
}

TEST(WrongLinesOfABusFile, AnEepromFileCannotHaveThePathOfAPseudoTerminal) {
  for (const std::string port : {"a", "b"}) {
    EXPECT_EQ(why_not("{\"lines\": [{\"pty\": \"a\", \"modules\": [{\"model\": \"EX9042D\"}]},\n"
                      "{\"pty\": \"b\", \"modules\": [{\"model\": \"EX9042D\", \"eeprom\": \"" +
                      port + "\"}]}]}"),
              "bus.json:2: lines[1].modules[0].eeprom: " + port +
                  ": is already used for something else; name another path");
  }
}

// --- bus files as arguments of the program ---

TEST(BusFile, IsRecognizedByTheExtensionJson) {
  EXPECT_TRUE(is_bus_file("bus.json"));
  EXPECT_TRUE(is_bus_file("a/b.json"));
  EXPECT_FALSE(is_bus_file(".json"));
  EXPECT_FALSE(is_bus_file("bus.json.bak"));
  EXPECT_FALSE(is_bus_file("EX9042D"));
}

TEST(BusFile, IsNoModuleWhoseLastValueEndsWithJson) {
  EXPECT_FALSE(is_bus_file("EX9042D@01,eeprom=a.json"));
  EXPECT_FALSE(is_bus_file("EX9042D,eeprom=folder/a.json"));
  EXPECT_FALSE(is_bus_file("EX1,baud=9600,eeprom=a.json"));
  EXPECT_TRUE(is_bus_file("north,2.json"));
  EXPECT_TRUE(is_bus_file("room=2.json"));
  EXPECT_TRUE(is_bus_file("./plant,room=2.json"));
}

TEST(BusFile, IsRefusedWithItsPathIfItIsNotARegularFile) {
  const system::Directory directory;
  std::filesystem::create_directory(directory / "folder.json");
  std::filesystem::create_symlink("/dev/zero", directory / "endless.json");
  ASSERT_EQ(mkfifo((directory / "pipe.json").c_str(), 0644), 0);
  for (const char* name : {"missing.json", "folder.json", "endless.json", "pipe.json"}) {
    const std::string path = directory / name;
    EXPECT_EQ(refusal([&] { read_bus_file(path); }),
              path + ": is not a file that can be read; 'ex9000-sim --example' prints a bus file");
  }
}

TEST(BusFile, MayBeginWithAByteOrderMark) {
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  system::write_file(path, "\xEF\xBB\xBF" + example_bus_file());
  EXPECT_EQ(read_bus_file(path).lines.size(), parse_bus_file(path, example_bus_file()).lines.size());
}

TEST(BusFile, IsRefusedAsUtf16WithAndWithoutAByteOrderMark) {
  using namespace std::string_literals;
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  for (const std::string& text : {"\xFF\xFE{\0}\0"s, "\xFE\xFF\0{\0}"s, "{\0}\0"s, "\0{\0}"s}) {
    system::write_file(path, text);
    EXPECT_EQ(refusal([&] { read_bus_file(path); }), path + ": is UTF-16; save it as UTF-8");
  }
}

Parsed parse(const std::vector<std::string>& words) {
  std::vector<const char*> argv{"ex9000-sim"};
  for (const std::string& word : words) {
    argv.push_back(word.c_str());
  }
  return parse_arguments(static_cast<int>(argv.size()), argv.data());
}

TEST(BusFile, ALineWithoutAPortGetsAPseudoTerminalNamedAfterTheLine) {
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  system::write_file(path, R"({"lines": [{"modules": [{"model": "EX9042D"}]},
    {"modules": [{"model": "EX9042D"}], "name": "hall"}, {"modules": [{"model": "EX9042D"}], "tcp": 0}]})");
  const Parsed with = parse({path});
  ASSERT_TRUE(with.setup) << with.error;
  EXPECT_EQ(with.setup->lines[0].pty, "line1.tty");
  EXPECT_EQ(with.setup->lines[1].pty, "hall.tty");
  EXPECT_FALSE(with.setup->lines[2].pty);
}

TEST(BusFile, AnErrorThatIsFoundAfterParsingIsReported) {
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  system::write_file(path,
                     "{\n\"watch\": true, \"lines\": [{\"modules\": [{\"model\": \"EX9042D\"}], \"pty\": "
                     "\"{b}.tty\"},\n{\"modules\": [{\"model\": \"EX9042D\"}], \"name\": \"{b}\"}]}");
  EXPECT_EQ(parse({path}).error, "ex9000-sim: " + path +
                                     ":3: lines[1]: {b}.tty: two lines cannot share a port; name one for "
                                     "each\n");
  EXPECT_EQ(parse({path, "--log", "json"}).error,
            "ex9000-sim: " + path +
                ":2: watch: cannot be combined with --log json, because both write to standard output; leave "
                "out one of them\n");
  EXPECT_EQ(
      parse({path, "--speed", "step"}).error,
      "ex9000-sim: --speed: step requires --control, because only the control socket advances the time\n");
}

TEST(BusFile, AnEepromFileWithAnotherUseIsReportedWithItsPlaceInTheBusFile) {
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  system::write_file(path,
                     "{\"lines\": [{\"modules\": [{\"model\": \"EX9042D\"},\n{\"model\": \"EX9042D\", "
                     "\"address\": \"02\", \"eeprom\": \"line1.tty\"}]}]}");
  EXPECT_EQ(parse({path}).error, "ex9000-sim: " + path +
                                     ":2: lines[0].modules[1].eeprom: line1.tty: is already used for "
                                     "something else; name another path\n");
}

TEST(BusFile, AnErrorNamesTheConflictingKeyOrOption) {
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  const auto error = [&path](const std::string& keys, const std::string& port,
                             const std::vector<std::string>& options) {
    system::write_file(path,
                       "{" + keys + "\"lines\": [{" + port + "\"modules\": [{\"model\": \"EX9042D\"}]}]}");
    std::vector<std::string> words{path};
    words.insert(words.end(), options.begin(), options.end());
    return parse(words).error;
  };
  const std::vector<std::string> max{"--speed", "max", "--for", "1s"};
  const std::vector<std::string> max_with_panel{"--speed", "max", "--for", "1s", "--panel"};
  const std::string cannot = "ex9000-sim: --speed: max cannot be combined with ";
  EXPECT_EQ(error("\"panel\": true, ", "", max), cannot + "'panel' in " + path + "; leave out one of them\n");
  EXPECT_EQ(error("\"panel\": true, ", "", max_with_panel), cannot + "--panel; leave out one of them\n");
  EXPECT_EQ(error("", "", max_with_panel), cannot + "--panel; leave out one of them\n");
  EXPECT_EQ(error("\"control\": \"a\", ", "", max),
            cannot + "'control' in " + path + "; leave out one of them\n");
  EXPECT_EQ(error("", "\"tcp\": 0, ", max),
            cannot + "'tcp' in " + path + ", because masters follow the wall clock; leave out one of them\n");
  EXPECT_EQ(error("\"log\": \"json\", ", "", {"--watch"}),
            "ex9000-sim: --watch: cannot be combined with 'log' json in " + path +
                ", because both write to standard output; leave out one of them\n");
}

TEST(BusFile, CanBeCombinedWithProgramOptionsButNotWithLineOptionsOrModules) {
  const system::Directory directory;
  const std::string path = directory / "bus.json";
  system::write_file(path, example_bus_file());
  const Parsed with = parse({path, "--control", "other.ctl", "--seed", "9", "--log"});
  ASSERT_TRUE(with.setup) << with.error;
  EXPECT_EQ(with.setup->control, "other.ctl");
  EXPECT_EQ(with.setup->seed, 9U);
  EXPECT_TRUE(with.setup->log);
  EXPECT_EQ(with.setup->lines.size(), 2U);
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--pty", "a"},
                                             {"--tcp", "1"},
                                             {"--modbus-tcp", "1"},
                                             {"--serial", "a"},
                                             {"--baud", "9600"},
                                             {"--format", "8E1"},
                                             {"--line", "paced"},
                                             {"--echo"},
                                             {"--strict-gaps"},
                                             {"--modbus-timeout", "1s"},
                                             {"--pty-access", "660"},
                                             {"--input", "1 0 square 1s"},
                                             {"--fault", "echo 2ms"}}) {
    std::vector<std::string> words{path};
    words.insert(words.end(), more.begin(), more.end());
    const Parsed refused = parse(words);
    EXPECT_FALSE(refused.setup);
    EXPECT_EQ(refused.error,
              "ex9000-sim: " + more[0] + ": cannot be combined with a bus file; add it to the bus file\n");
  }
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{path, "EX9042D"}, {"EX9042D", path}, {path, path}}) {
    const Parsed refused = parse(words);
    EXPECT_FALSE(refused.setup);
    EXPECT_EQ(refused.error,
              "ex9000-sim: " + path + ": a bus file has all modules; leave out the other arguments\n");
  }
}

}  // namespace
}  // namespace ex9000::sim
