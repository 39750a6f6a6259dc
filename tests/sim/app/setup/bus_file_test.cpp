// Tests bus files, which describe lines and their modules.
#include "sim/app/setup/bus_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sim/app/main/arguments.hpp"
#include "sim/app/setup/schema.hpp"
#include "sim/notation/module_settings.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

Setup parsed(const std::string& text) { return parse_bus_file("bus.yaml", text); }

/// The message for a bus file, without the prefix `bus.yaml:`.
std::string why_not(const std::string& text) {
  const std::string why = refusal([&] { parsed(text); });
  EXPECT_EQ(why.rfind("bus.yaml:", 0), 0U) << why;
  EXPECT_EQ(why.find('\n'), std::string::npos) << why;
  return why.substr(9);
}

/// A bus file with one line, whose further keys begin in the third line of the text.
std::string line_with(const std::string& keys) { return "lines:\n- modules: [EX9052D-M]\n  " + keys + "\n"; }
/// A bus file with one module, whose further keys begin in the third line of the text.
std::string module_with(const std::string& keys) {
  return "lines:\n- modules: [{model: EX9052D-M,\n    " + keys + "}]\n";
}

LineSetup line_of(const std::string& keys) { return parsed(line_with(keys)).lines.at(0); }
ModuleSpec module_of(const std::string& keys) { return parsed(module_with(keys)).lines.at(0).modules.at(0); }

std::vector<std::string> ports_of(const LineSetup& line) {
  std::vector<std::string> texts;
  for (const PortSetup& port : line.ports) {
    texts.push_back(port.text);
  }
  return texts;
}

// --- valid files ---

TEST(BusFile, TheExampleGivesTheExpectedSetup) {
  const auto setup = parsed(example_bus_file());
  EXPECT_EQ(setup.control, "ex9000.ctl");
  EXPECT_TRUE(setup.panel);
  ASSERT_EQ(setup.lines.size(), 2U);

  const LineSetup& hall = setup.lines[0];
  EXPECT_EQ(hall.name, "hall");
  EXPECT_EQ(ports_of(hall), std::vector<std::string>{"pty:hall.tty"});
  EXPECT_EQ(hall.baud, 9600U);
  ASSERT_EQ(hall.modules.size(), 2U);
  EXPECT_EQ(hall.modules[0].model->designation, "EX9042D-M");
  EXPECT_EQ(hall.modules[0].settings.address, 1);
  EXPECT_EQ(hall.modules[0].eeprom, "hall-01.bin");
  ASSERT_EQ(hall.modules[0].faults.size(), 2U);
  EXPECT_EQ(hall.modules[0].faults[1].text, "power-cut after 3 writes");
  EXPECT_EQ(hall.modules[1].settings.address, 2);
  EXPECT_EQ(hall.modules[1].settings.format, 0x80);
  ASSERT_EQ(hall.modules[1].inputs.size(), 2U);
  EXPECT_EQ(hall.modules[1].inputs[0].time, 100ms);
  EXPECT_EQ(hall.modules[1].inputs[1].bounce, 5ms);
  ASSERT_EQ(hall.faults.size(), 2U);
  EXPECT_EQ(hall.faults[0].text, "bit-errors 1e-5");

  const LineSetup& yard = setup.lines[1];
  EXPECT_EQ(ports_of(yard), (std::vector<std::string>{"tcp:5020", "modbus-tcp:5021"}));
  EXPECT_EQ(yard.ports[1].timeout, 1s);
  EXPECT_TRUE(yard.instant);
  ASSERT_EQ(yard.modules.size(), 2U);
  EXPECT_EQ(yard.modules[0].settings.protocol, Protocol::Ascii);
  EXPECT_EQ(yard.modules[0].settings.name, Name("PUMPS"));
  EXPECT_EQ(yard.modules[1].settings.address, 0x0B);
  EXPECT_EQ(yard.modules[1].faults.at(0).text, "gone at 1h for 2min");
}

TEST(BusFile, ALineAcceptsTheOptionsOfTheCommandLineAsKeys) {
  EXPECT_EQ(ports_of(line_of("port: tcp:5020")), std::vector<std::string>{"tcp:5020"});
  EXPECT_EQ(line_of("port: ['tcp:[::1]:5020', \"serial:/dev/ttyUSB0,echo\"]").ports.at(0).address.host,
            "::1");
  EXPECT_EQ(line_of("baud: 19200").baud, 19200U);
  EXPECT_EQ(line_of("format: 8E1").format, LineFormat::k8E1);
  EXPECT_TRUE(line_of("timing: instant").instant);
  EXPECT_TRUE(line_of("strict-gaps: on").strict_gaps);
  EXPECT_TRUE(line_of("strict-gaps: true").strict_gaps);
  EXPECT_FALSE(line_of("strict-gaps: false").strict_gaps);
  EXPECT_EQ(line_of("name: hall").name, "hall");
  EXPECT_EQ(line_of("fault: echo 2ms").faults.size(), 1U);
}

TEST(BusFile, AModuleAcceptsTheKeysOfTheCommandLine) {
  EXPECT_EQ(module_of("address: 0F").settings.address, 0x0F);
  EXPECT_EQ(module_of("address: 10").settings.address, 0x10);
  EXPECT_EQ(module_of("protocol: ascii").settings.protocol, Protocol::Ascii);
  EXPECT_EQ(module_of("baud: 115200, format: 8O1").settings.baud_code, 0xCA);
  EXPECT_EQ(module_of("checksum: true").settings.format, 0x40);
  EXPECT_EQ(module_of("checksum: on").settings.format, 0x40);
  EXPECT_EQ(module_of("checksum: false").settings.format, 0x00);
  EXPECT_EQ(module_of("name: 'a b,c'").settings.name,
            Name("a b,c"));  // a comma would end it on a command line
  EXPECT_EQ(module_of("name: true").settings.name, Name("true"));
  EXPECT_TRUE(module_of("init: on").init_asserted);
  EXPECT_EQ(module_of("eeprom: 'a,b.bin'").eeprom, "a,b.bin");
}

TEST(BusFile, RunsTakeTheOptionsOfTheCommandLineAsKeys) {
  const auto setup =
      parsed("seed: 7\nlog: json\npanel: 8080\nspeed: step\nfor: 10s\n" + line_with("baud: 9600"));
  EXPECT_EQ(setup.seed, 7U);
  EXPECT_EQ(setup.log, LogFormat::Json);
  EXPECT_EQ(setup.panel->port, 8080);
  EXPECT_TRUE(setup.speed.stepped());
  EXPECT_EQ(setup.lasts, 10s);
  EXPECT_FALSE(parsed("panel: false\n" + line_with("baud: 9600")).panel);
  EXPECT_FALSE(parsed("panel: on\n" + line_with("baud: 9600")).panel->port);
}

TEST(BusFile, KeysMayComeInAnyOrderAndJsonIsYaml) {
  const auto setup = parsed(
      "{\"seed\":7,\t\"lines\": [\n\t{\"fault\": [\"echo 2ms\"], \"modules\": [\n"
      "\t\t{\"fault\":[\"gone\"], \"input\": [\"7 square 1s\"], \"address\": \"02\",\n"
      "\t\t \"model\":\"EX9052D\"}], \"port\":\"pty:a\\u0062\"}]}\n");
  EXPECT_EQ(setup.seed, 7U);
  EXPECT_EQ(setup.lines[0].ports[0].path, "ab");
  EXPECT_EQ(setup.lines[0].modules[0].settings.address, 2);
  EXPECT_EQ(setup.lines[0].modules[0].inputs.size(), 1U);
  EXPECT_EQ(setup.lines[0].modules[0].faults.size(), 1U);
  EXPECT_EQ(setup.lines[0].faults.size(), 1U);
}

// --- files that the program rejects ---

TEST(BusFile, AWrongFileIsRefusedWithALineNumberAndAKey) {
  const std::string known = "unknown key; expected one of ";
  const std::string lines = "\nlines: [{modules: [EX9042D]}]";
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"", "1: expected a bus file, as 'ex9000-sim --example' prints it"},
           {"---\nseed: 1\n---\nseed: 2\n", "3: expected the end of the file"},
           {"{seed: 1}\n}", "2: illegal flow end"},
           {"{},\n{}", "1: expected the end of the file"},
           {"{\n\"lines\": [\n}\n", "3: "},
           {"lines: [1,2,,]", "1: "},
           {"a: b: c", "1: "},
           {"[]", "1: expected keys with values"},
           {"5", "1: expected keys with values"},
           {"seed: 1\nseed: 2", "2: seed: is given twice; leave out one of them"},
           {"\nseed: 1", "2: lines: a bus file requires at least one line; 'ex9000-sim --example' prints"},
           {"lines: {}", "1: lines: expected a list"},
           {"lines: []", "1: lines: a bus file requires at least one line"},
           {"lines: [{modules: EX9042D}]", "1: modules: expected a list"},
           {"line: []", "1: line: " + known + "lines, log, capture, panel, control, speed, for, seed"},
           {"log: xml" + lines, "1: log: 'xml': expected text, json, on or off"},
           {"panel: 70000" + lines, "1: panel: '70000': expected a port from 0 to 65535"},
           {"panel: []" + lines, "1: panel: expected a single value"},
           {"seed: 1.5" + lines, "1: seed: '1.5': expected a whole number"},
           {"seed:\nlog: on" + lines, "1: seed: has no value; write one, or leave the key out"},
           {"capture: ''" + lines, "1: capture: is empty; name a path"},
           {"control: \"a\\0b\"" + lines, "1: control: contains NUL; leave out \\0"},
           {"lines:\n- 5", "2: expected keys with values"},
           {"lines:\n- port: pty:a", "2: modules: a line requires at least one module"},
           {"lines:\n- modules: []", "2: modules: a line requires at least one module"},
           {"lines:\n- modules: [[]]", "2: expected keys with values"},
           {"lines:\n- modules:\n  - {}", "3: model: is missing; expected a model's name"},
           {"lines:\n- modules:\n  - input: 7 square 1s", "3: model: is missing; expected a model's name"},
           {"lines:\n- modules:\n  - model: EX1", "3: model: 'EX1' is not a model; 'ex9000-sim --models'"},
           {"lines:\n- modules:\n  - EX9042D,baud=1", "3: EX9042D,baud=1: baud=: '1': expected a baud rate"},
       }) {
    const std::string refused = why_not(text);
    EXPECT_EQ(refused.rfind(why, 0), 0U) << text << " -> " << refused;
  }
}

TEST(BusFile, AWrongKeyOfALineIsRefused) {
  for (const auto& [keys, why] : std::vector<std::pair<std::string, std::string>>{
           {"speed: 1", "speed: unknown key; expected one of modules, port, baud"},
           {"baud: 300", "baud: '300': expected a baud rate: 1200"},
           {"timing: fast", "timing: 'fast': expected instant or paced"},
           {"strict-gaps: yes", "strict-gaps: 'yes': expected on or off"},
           {"port: tcp:here", "port: tcp:here: 'here': expected HOST:PORT or a port"},
           {"port: {}", "port: expected a single value"},
           {"port: [[]]", "port: expected a single value"},
           {"name: the hall", "name: 'the hall': expected one word of ASCII characters"},
           {"fault: [echo 2ms, gone at]", "fault: gone at: ends too early; expected a time after 'at'"},
       }) {
    const std::string refused = why_not(line_with(keys));
    EXPECT_EQ(refused.rfind("3: " + why, 0), 0U) << refused;
  }
}

TEST(BusFile, AWrongKeyOfAModuleIsRefused) {
  for (const auto& [keys, why] : std::vector<std::pair<std::string, std::string>>{
           {"colour: red", "colour: unknown key; expected one of model, address"},
           {"address: 100", "address: '100': expected one or two hex digits"},
           {"protocol: rtu", "protocol: 'rtu': expected modbus or ascii"},
           {"format: 8N3", "format: '8N3': expected a line format: 8N1, 8N2, 8E1 or 8O1"},
           {"checksum: 2", "checksum: '2': expected on or off"},
           {"edge: up", "edge: 'up': expected rising or falling"},
           {"name: TOOLONG", "name: 'TOOLONG': expected 1 to 6 printable ASCII characters for the EX9052D-M"},
           {"eeprom: ''", "eeprom: is empty; name a path"},
           {"input: ['']", "input: the channel is missing; expected 'CHANNEL square PERIOD'"},
           {"input: 8 square 1s", "input: 8 square 1s: the EX9052D-M has no input '8'; it has 0 to 7"},
           {"fault: [hang, lost]", "fault: 'lost' is not a fault; expected one of bit-errors"},
           {"fault: echo 2ms",
            "fault: echo 2ms: concerns the line, not a module; add it as a fault of the line"},
       }) {
    const std::string refused = why_not(module_with(keys));
    EXPECT_EQ(refused.rfind("3: " + why, 0), 0U) << refused;
  }
  EXPECT_EQ(why_not(module_with("address: 00")),
            "2: address 00: is not a Modbus address; expected hex 01 to F7, or the protocol ascii");
}

// --- bus files as arguments of the program ---

TEST(BusFile, IsRecognizedByItsExtension) {
  for (const char* name :
       {"bus.json", "a/b.yaml", "b.yml", "north,2.json", "room=2.json", "./plant,room=2.json"}) {
    EXPECT_TRUE(is_bus_file(name)) << name;
  }
  for (const char* name : {".json", ".yaml", "bus.json.bak", "EX9042D", "EX9042D@01,eeprom=a.json",
                           "EX9042D,eeprom=folder/a.yaml", "EX1,baud=9600,eeprom=a.json"}) {
    EXPECT_FALSE(is_bus_file(name)) << name;
  }
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
  const std::string path = directory / "bus.yaml";
  system::write_file(path, "\xEF\xBB\xBF" + example_bus_file());
  EXPECT_EQ(read_bus_file(path).lines.size(), 2U);
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

/// A bus file and the program's command line that names it.
class Argument {
 public:
  explicit Argument(const std::string& text) { system::write_file(path_, text); }

  Parsed parse(const std::vector<std::string>& options = {}) const {
    std::vector<const char*> argv{"ex9000-sim", path_.c_str()};
    for (const std::string& option : options) {
      argv.push_back(option.c_str());
    }
    return parse_arguments(static_cast<int>(argv.size()), argv.data());
  }
  /// The error without `ex9000-sim: ` and, if it begins with the path, without the path.
  std::string error(const std::vector<std::string>& options = {}) const {
    const Parsed parsed = parse(options);
    if (parsed.setup) {
      return "";
    }
    const std::string text = parsed.error.substr(12);
    return text.rfind(path_, 0) == 0 ? text.substr(path_.size()) : text;
  }
  const std::string& path() const { return path_; }

 private:
  system::Directory directory_;
  std::string path_ = directory_ / "bus.yaml";
};

TEST(BusFile, LinesGetNamesAndPseudoTerminals) {
  const Argument file(
      "lines: [{modules: [EX9042D]}, {modules: [EX9042D], name: hall}, {modules: [EX9042D], port: tcp:0}]");
  const Parsed with = file.parse();
  ASSERT_TRUE(with.setup) << with.error;
  EXPECT_EQ(ports_of(with.setup->lines[0]), std::vector<std::string>{"pty:line1.tty"});
  EXPECT_EQ(ports_of(with.setup->lines[1]), std::vector<std::string>{"pty:hall.tty"});
  EXPECT_EQ(ports_of(with.setup->lines[2]), std::vector<std::string>{"tcp:0"});
  EXPECT_EQ(with.setup->lines[2].name, "line3");
}

TEST(BusFile, NoPathAddressOrNameHasTwoUses) {
  const auto error = [](const std::string& first, const std::string& second) {
    return Argument("lines:\n- modules: [EX9042D]\n  " + first + "\n- modules: [EX9042D]\n  " + second + "\n")
        .error();
  };
  EXPECT_EQ(error("port: pty:a", "port: pty:./a"), ":5: port: ./a: is already used; name another path\n");
  EXPECT_EQ(error("port: serial:a", "port: serial:a"), ":5: port: a: is already used; name another path\n");
  EXPECT_EQ(error("port: tcp:5020", "port: modbus-tcp:localhost:5020"),
            ":5: port: modbus-tcp:localhost:5020: two ports cannot share an address; name one for each\n");
  EXPECT_EQ(error("{name: a, port: tcp:0}", "name: a").rfind(":3: ", 0), 0U);  // not YAML
  EXPECT_EQ(error("name: a", "name: a"),
            ":5: name: a: two lines have this name; give each line a different name\n");
  EXPECT_EQ(Argument("lines:\n- modules: [EX9042D]\n- name: line1\n  modules: [EX9042D]\n").error(),
            ":3: name: line1: two lines have this name; give each line a different name\n");
  EXPECT_EQ(Argument("lines:\n- modules: [EX9042D]\n  name: line2\n- modules: [EX9042D]\n").error(),
            ":4: name: line2: two lines have this name; give each line a different name\n");
  EXPECT_EQ(error("port: tcp:0", "port: tcp:0"), "");
  EXPECT_EQ(
      Argument("lines:\n- modules:\n  - EX9042D\n  - {model: EX9042D, address: 02, eeprom: line1.tty}\n")
          .error(),
      ":4: eeprom: line1.tty: is already used; name another path\n");
  EXPECT_EQ(Argument("control: a\nlines:\n- port: pty:a\n  modules: [EX9042D]\n").error(),
            ":1: control: a: is already used; name another path\n");
}

TEST(BusFile, AnErrorNamesThePlaceOfTheValue) {
  const Argument file("control: c\npanel: on\nlines:\n- {modules: [EX9042D], port: tcp:0}\n");
  EXPECT_EQ(file.error({"--speed", "max", "--for", "1s"}),
            "--speed: max cannot be combined with control or panel; leave out one of them\n");
  EXPECT_EQ(Argument("speed: step\n" + line_with("port: tcp:0")).error(),
            ":1: speed: step requires control, because only the control socket advances the time\n");
}

TEST(BusFile, OptionsOfTheRunOverrideItsKeysAndOptionsOfALineAreRefused) {
  const Argument file(example_bus_file());
  const Parsed with = file.parse({"--control", "other.ctl", "--seed", "9", "--log", "--panel", "off"});
  ASSERT_TRUE(with.setup) << with.error;
  EXPECT_EQ(with.setup->control, "other.ctl");
  EXPECT_EQ(with.setup->seed, 9U);
  EXPECT_TRUE(with.setup->log);
  EXPECT_FALSE(with.setup->panel);
  for (const Setting<LineSetup>& setting : line_settings) {
    const std::string option = "--" + std::string(setting.name);
    EXPECT_EQ(file.error({option + "=1"}),
              option + ": cannot be combined with a bus file; add it to the bus file\n");
  }
  for (const std::string& other : {std::string("EX9042D"), file.path()}) {
    EXPECT_EQ(file.error({other}), ": a bus file has all modules; leave out the other arguments\n");
  }
}

TEST(BusFile, TheSchemaHasEachKeyOfALineAndOfAModule) {
  const std::string schema = bus_file_schema();
  for (const Setting<LineSetup>& setting : line_settings) {
    EXPECT_NE(schema.find("\"" + std::string(setting.name) + "\": {"), std::string::npos) << setting.name;
  }
  for (const Setting<ModuleSpec>& setting : module_settings) {
    EXPECT_NE(schema.find("\"" + std::string(setting.name) + "\": {"), std::string::npos) << setting.name;
  }
}

}  // namespace
}  // namespace ex9000::sim
