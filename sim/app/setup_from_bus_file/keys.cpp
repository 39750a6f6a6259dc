#include "sim/app/setup_from_bus_file/keys.hpp"

#include <string>
#include <utility>

#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

constexpr std::string_view kText = R"({"type": "string"})";
constexpr std::string_view kPath = R"({"type": "string", "minLength": 1})";
constexpr std::string_view kFlag = R"({"type": "boolean"})";
constexpr std::string_view kOnOff = R"({"enum": [true, false, "on", "off"]})";
constexpr std::string_view kTexts = R"({"type": "array", "items": {"type": "string"}})";
constexpr std::string_view kRate =
    R"({"enum": [1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200,
                 "1200", "2400", "4800", "9600", "19200", "38400", "57600", "115200"]})";
constexpr std::string_view kFormat = R"({"enum": ["8N1", "8N2", "8E1", "8O1", "8n1", "8n2", "8e1", "8o1"]})";
constexpr std::string_view kPort =
    R"({"anyOf": [{"type": "integer", "minimum": 0, "maximum": 65535}, {"type": "string", "minLength": 1}]})";
constexpr std::string_view kNumber =
    R"({"anyOf": [{"type": "integer", "minimum": 0}, {"type": "string", "pattern": "^[0-9]+$"}]})";

/// Records the place of each member of a JSON object, and calls the `take` of the member's key. Rejects
/// unknown keys.
template <class Object, std::size_t kSize>
void read_members(const Node& node, const std::array<BusFileKey<Object>, kSize>& keys, Object& object) {
  node.members([&](const std::string& name, const Node& member) {
    for (const BusFileKey<Object>& key : keys) {
      if (key.name == name) {
        object.places[name] = member.place();
        key.take(object, member);
        return;
      }
    }
    member.refuse("unknown key; expected one of " + names_of(keys));
  });
}

/// Sets the setting that the value's key names. `kRead` determines which types of JSON values are accepted.
template <std::string (Node::*kRead)() const>
void take_setting(ModuleObject& module, const Node& value) {
  apply_setting(module.spec, value.key(), (value.*kRead)());
}

void read_module(const Node& node, LineSetup& line) {
  ModuleObject module{{}, line, {}};
  node.members([&](const std::string& key, const Node& value) {
    if (key == "model") {
      module.spec = factory_fresh(model_called(value.text()));
    }
  });
  if (module.spec.model == nullptr) {
    node.refuse("model", "is missing; expected a model's name, for example \"EX9042D-M\"");
  }
  read_members(node, module_keys, module);
  check(module.spec);
  line.modules.push_back(std::move(module.spec));
}

void read_line(const Node& node, Setup& setup) {
  LineSetup line;
  line.places["fault"] = node.place();
  line.places["pty"] = node.place();  // for a pseudo-terminal that the file does not name
  read_members(node, line_keys, line);
  if (line.modules.empty()) {
    node.refuse("modules", R"(a line requires at least one module, for example {"model": "EX9042D-M"})");
  }
  if (line.name.empty()) {
    line.name = "line" + std::to_string(setup.lines.size() + 1);
  }
  setup.lines.push_back(std::move(line));
}

}  // namespace

const std::array<BusFileKey<Setup>, 7> bus_keys{{
    {"lines", R"({"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/line"}})",
     "the lines, at least one",
     [](Setup& setup, const Node& value) {
       value.elements([&](const Node& line) { read_line(line, setup); });
     }},
    {"control", kPath, "creates the control socket at this path",
     [](Setup& setup, const Node& value) { setup.control = value.text(); }},
    {"panel", R"({"anyOf": [{"type": "boolean"}, {"type": "integer", "minimum": 0, "maximum": 65535},
                            {"type": "string", "pattern": "^([0-9]+|on|off)?$"}]})",
     "serves the panel, at this port if one is named",
     [](Setup& setup, const Node& value) {
       const std::string panel = value.setting();
       setup.panel = parse_panel(panel == "on" ? "" : panel);
     }},
    {"watch", kFlag, "shows the modules in the terminal",
     [](Setup& setup, const Node& value) { setup.watch = value.flag(); }},
    {"log", R"({"enum": [true, false, "text", "json", "on", "off"]})", "prints the bus log",
     [](Setup& setup, const Node& value) {
       const std::string log = value.flag_or_text();
       setup.log = parse_log(log == "on" ? "text" : log);
     }},
    {"capture", kPath, "writes a capture for Wireshark to this file",
     [](Setup& setup, const Node& value) { setup.capture = value.text(); }},
    {"seed", kNumber, "seed of faults and bouncing contacts (default 1)",
     [](Setup& setup, const Node& value) { setup.seed = parse_seed(value.number_or_text()); }},
}};

const std::array<BusFileKey<LineSetup>, 14> line_keys{{
    {"name", kText, "the line's name, one word (default: line1, line2, ...)",
     [](LineSetup& line, const Node& value) { line.name = value.text(); }},
    {"pty", kPath,
     "creates a pseudo-terminal and links it at this path (default: NAME.tty if the line has no other port)",
     [](LineSetup& line, const Node& value) { line.pty = value.text(); }},
    {"pty-access", kText,
     "mode and group of the pseudo-terminal: MODE[:GROUP], for example 660:dialout (default: as the system "
     "creates it)",
     [](LineSetup& line, const Node& value) { line.pty_access = parse_pty_access(value.text()); }},
    {"tcp", kPort, "serves the line's bytes at HOST:PORT, or at a port of 127.0.0.1",
     [](LineSetup& line, const Node& value) { line.tcp = parse_listening_address(value.number_or_text()); }},
    {"modbus-tcp", kPort,
     "serves the line's Modbus modules at HOST:PORT, or at a port of 127.0.0.1, for Modbus TCP",
     [](LineSetup& line, const Node& value) {
       line.modbus_tcp = parse_listening_address(value.number_or_text());
     }},
    {"modbus-timeout", kText,
     "how long the gateway of modbus-tcp waits for a reply, plus the time that the line needs (default "
     "200ms)",
     [](LineSetup& line, const Node& value) { line.modbus_timeout = parse_time(value.text()); }},
    {"serial", kPath, "connects the modules to this serial port",
     [](LineSetup& line, const Node& value) { line.serial = value.text(); }},
    {"echo", kFlag, "ignores the echo of an adapter that receives what it sends",
     [](LineSetup& line, const Node& value) { line.echo = value.flag(); }},
    {"baud", kRate,
     "the line's baud rate at the start; a master on a pseudo-terminal can change it (default: the first "
     "module's)",
     [](LineSetup& line, const Node& value) { line.baud = parse_baud_rate(value.number_or_text()); }},
    {"format", kFormat,
     "the line's format; a pseudo-terminal and TCP do not carry it (default: the first module's)",
     [](LineSetup& line, const Node& value) { line.format = parse_line_format(value.text()); }},
    {"line", R"({"enum": ["paced", "instant"]})",
     "paced: bytes take as long as on a real line; instant: bytes take no time (default: paced)",
     [](LineSetup& line, const Node& value) { line.instant = parse_line_kind(value.text()); }},
    {"strict-gaps", kFlag,
     "makes modules ignore a Modbus frame with a gap of more than 1.5 characters; the simulator then "
     "does not insert the silence that a master omits between frames",
     [](LineSetup& line, const Node& value) { line.strict_gaps = value.flag(); }},
    {"modules", R"({"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/module"}})",
     "the modules, at least one",
     [](LineSetup& line, const Node& value) {
       value.elements([&](const Node& module) { read_module(module, line); });
     }},
    {"faults", kTexts, "faults of the line, or of all its modules",
     [](LineSetup& line, const Node& value) {
       value.elements([&](const Node& fault) { line.faults.push_back(parse_fault(fault.text())); });
     }},
}};

const std::array<BusFileKey<ModuleObject>, 12> module_keys{{
    {"model", kText, "the model, as --models lists it, in upper or lower case, with or without EX; required",
     [](ModuleObject& /*module*/, const Node& /*value*/) {
     }},  // read_module has read it already, because other keys depend on it
    {"address", R"({"type": "string", "pattern": "^[0-9A-Fa-f]{1,2}$"})",
     "the address of the module, one or two hex digits (default 01)",
     [](ModuleObject& module, const Node& value) { set_address(module.spec, value.text()); }},
    {"protocol", R"({"enum": ["ascii", "modbus"]})",
     "the module's protocol (default: modbus for -M models, else ascii)", take_setting<&Node::text>},
    {"baud", kRate, "the module's baud rate (default 9600)", take_setting<&Node::number_or_text>},
    {"format", kFormat, "the module's line format (default 8N1)", take_setting<&Node::text>},
    {"checksum", kOnOff, "checksums of ASCII frames (default off)", take_setting<&Node::flag_or_text>},
    {"edge", R"({"enum": ["falling", "rising"]})", "the edge that the counters count (default falling)",
     take_setting<&Node::text>},
    {"name", kText, "the name that $AAM reads (default: the model's)", take_setting<&Node::text>},
    {"init", kOnOff, "INIT* is tied to GND (default off)", take_setting<&Node::flag_or_text>},
    {"eeprom", kPath, "keeps the module's settings in this file",
     [](ModuleObject& module, const Node& value) {
       module.spec.eeprom_place = value.place() + ": ";
       take_setting<&Node::text>(module, value);
     }},
    {"inputs", kTexts, "inputs that change by themselves",
     [](ModuleObject& module, const Node& value) {
       value.elements([&](const Node& input) {
         module.spec.inputs.push_back(parse_input_program(input.text(), *module.spec.model));
       });
     }},
    {"faults", kTexts, "faults of this module",
     [](ModuleObject& module, const Node& value) {
       value.elements([&](const Node& text) {
         Fault fault = parse_fault(text.text());
         if (!concerns_a_module(fault.trouble)) {
           text.refuse("concerns the line, not a module; move it to the line's faults");
         }
         fault.module = module.line.modules.size();
         module.line.faults.push_back(fault);
       });
     }},
}};

Setup read_bus(const Node& root) {
  Setup setup;
  read_members(root, bus_keys, setup);
  if (setup.lines.empty()) {
    root.refuse("lines", "a bus file requires at least one line; 'ex9000-sim --example' prints an example");
  }
  return setup;
}

}  // namespace ex9000::sim
