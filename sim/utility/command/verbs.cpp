#include <limits>

#include "sim/text/durations.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/command/panel.hpp"
#include "sim/utility/command/scan_line.hpp"
#include "sim/utility/command/send.hpp"
#include "sim/utility/command/set.hpp"
#include "sim/utility/command/show.hpp"
#include "sim/utility/command/verify_module.hpp"
#include "sim/utility/master_line/master_line.hpp"
#include "sim/utility/update/session.hpp"

namespace ex9000::utility {

namespace {

bool update(Environment& environment, const sim::Words& args, const Options& options) {
  const Port port = parse_port(args.front());
  std::vector<Addressee> modules;
  for (const std::string& module : expand_modules({args[1]})) {
    modules.push_back(parse_addressee(module));
  }
  const UpdateFile file = read_update_file(args[2]);
  MasterLine line(environment, port, options.line);
  return update_modules(environment, line.modbus(), modules, file, options.wait);
}

}  // namespace

const std::vector<sim::Setting<Options>> known_options{
    {"baud", sim::Form::Choice, "1200|2400|4800|9600|19200|38400|57600|115200",
     "the rate of the line (default: 9600; of a scan: all)",
     [](Options& taken, const std::string& value) { taken.line.baud = sim::parse_baud_rate(value); }},
    {"format", sim::Form::Choice, "8N1|8N2|8E1|8O1", "the format of the line (default: 8N1; of a scan: all)",
     [](Options& taken, const std::string& value) { taken.line.format = sim::parse_line_format(value); }},
    {"checksum", sim::Form::Flag, "on|off", "add a checksum to DCON commands",
     [](Options& taken, const std::string& value) { taken.checksum = sim::parse_on_off(value); }},
    {"ascii", sim::Form::Flag, "on|off", "the module speaks ASCII (default: find out)",
     [](Options& taken, const std::string& /*value*/) { taken.speaks = Speaks::Ascii; }},
    {"modbus", sim::Form::Flag, "on|off", "the module speaks Modbus (default: find out)",
     [](Options& taken, const std::string& /*value*/) { taken.speaks = Speaks::Modbus; }},
    {"model", sim::Form::Text, "MODEL", "the model, for a module that does not tell it",
     [](Options& taken, const std::string& value) { taken.model = value; }},
    {"entry", sim::Form::Text, "N", "take the settings of the module with this address or serial number",
     [](Options& taken, const std::string& value) { taken.entry = value; }},
    {"dry-run", sim::Form::Flag, "on|off", "only say what would change",
     [](Options& taken, const std::string& value) { taken.dry_run = sim::parse_on_off(value); }},
    {"every", sim::Form::Text, "TIME", "the time between two polls (default: 1s)",
     [](Options& taken, const std::string& value) { taken.every = sim::parse_time(value); }},
    {"count", sim::Form::Text, "N", "end after N polls",
     [](Options& taken, const std::string& value) {
       taken.rounds = static_cast<std::uint32_t>(
           sim::parse_whole_number(value, 1, std::numeric_limits<std::uint32_t>::max()));
     }},
    {"fast", sim::Form::Flag, "on|off",
     "only by serial numbers: -M models of this firmware, within seconds; finds all addresses",
     [](Options& taken, const std::string& value) { taken.fast = sim::parse_on_off(value); }},
    {"addresses", sim::Form::Text, "FIRST-LAST", "only these addresses (default: all)",
     [](Options& taken, const std::string& value) { taken.addresses = value; }},
    {"timeout", sim::Form::Text, "TIME",
     "how long to wait for a reply, for slow gateways (default of a scan: 80ms, because the\n"
     "response delay of a module may be 30ms)",
     [](Options& taken, const std::string& value) { taken.timeout = sim::parse_time(value); }},
    {"json", sim::Form::Flag, "on|off", "print an object of JSON for each module",
     [](Options& taken, const std::string& value) { taken.json = sim::parse_on_off(value); }},
    {"wait", sim::Form::Flag, "on|off",
     "wait until the modules have confirmed the image: 60 s after its start, if no reset has come in between",
     [](Options& taken, const std::string& value) { taken.wait = sim::parse_on_off(value); }},
    {"rig", sim::Form::Text, "COMMAND",
     "start this program, which switches the supply, INIT* and the inputs (default: ask at the terminal)",
     [](Options& taken, const std::string& value) { taken.rig = value; }},
    {"report", sim::Form::Text, "FILE", "write the report to this file (default: standard output)",
     [](Options& taken, const std::string& value) { taken.report = value; }},
};

const std::vector<Verb> verbs{
    {"scan PORT",
     "look for all modules, whatever their rate, format, protocol and address",
     R"(
Looks for those that answer by serial number first, then asks each address. In all 24 modes this takes half an
hour, so narrow it, or begin with --fast. Changes nothing, and clears nothing; but a module with
watchdog-feed=requests takes each request for a sign of life of its master.

Examples:
  ex9000 scan /dev/ttyUSB0 --baud 9600 --addresses 1-32
)",
     {"baud", "format", "ascii", "modbus", "addresses", "fast", "timeout", "json"},
     scan_line},
    {"show PORT MODULE",
     "print what a module is, its settings and its state, with warnings",
     R"(
Reads only what has no side effect, but a module with watchdog-feed=requests takes each request for a sign of
life of its master.
)",
     {"baud", "format", "ascii", "modbus", "model", "timeout"},
     show},
    {"poll PORT MODULES",
     "print inputs, outputs, latches and counters again and again, in a terminal in the same place",
     "",
     {"baud", "format", "ascii", "modbus", "model", "timeout", "every", "count"},
     poll},
    {"panel PORT",
     "show the modules in a browser: inputs, outputs, settings, frames, and a console",
     R"(
Looks for the modules first, as scan does, but only at one rate and format; PORT is a serial port or
tcp:HOST:PORT. Then prints the address of the page, and polls the modules until Ctrl-C; a module with
watchdog-feed=requests takes each request for a sign of life of its master.

Examples:
  ex9000 panel /dev/ttyUSB0 --baud 19200 --addresses 1-12 --modbus
)",
     {"baud", "format", "ascii", "modbus", "addresses", "fast", "timeout"},
     panel},
    {"set PORT MODULES KEY=VALUE...",
     "change settings of modules",
     "",
     {"baud", "format", "ascii", "modbus", "model", "timeout", "dry-run"},
     set},
    {"address PORT SERIAL ADDRESS",
     "give the module with a serial number another address, in force at once",
     R"(
For modules with the same address. They must speak Modbus.
)",
     {"baud", "format"},
     set_address_by_number},
    {"save PORT MODULES FILE",
     "save the settings of modules in a YAML file",
     "",
     {"baud", "format", "ascii", "modbus", "model", "timeout"},
     save},
    {"restore PORT MODULE FILE",
     "change a module's settings to those in a file",
     R"(
The file must have settings of the same model. If it has several modules, those of the module with the
address or the serial number MODULE are taken, or those of --entry.
)",
     {"baud", "format", "ascii", "modbus", "model", "timeout", "entry", "dry-run"},
     restore},
    {"send PORT REQUEST...",
     "send one request, and print it and its reply in words",
     R"(
Examples:
  ex9000 send /dev/ttyUSB0 '$01M'
  ex9000 send modbus-tcp:10.0.0.7 01 03 0000 0008
)",
     {"baud", "format", "checksum"},
     send},
    {"update PORT MODULES FILE",
     "send an update file to modules",
     R"(
They keep working while they receive it, and start the new image together, when all have it. What a module
has received stays: after an interruption, the same command continues.

Examples:
  ex9000 update /dev/ttyUSB0 5-7,0D001F3A EX9042D-M.ex9fw --baud 115200 --wait
)",
     {"baud", "format", "wait"},
     update},
    {"verify PORT MODULE FILE...",
     "play conformance transcripts against a module",
     R"(
The module must be alone on the line, and what its outputs switch, disconnected. All settings change, and
are restored at the end, also after Ctrl-C. What the rig cannot do is listed as not verified;
sim/docs/verify.md says what a rig must do.

Examples:
  ex9000 verify /dev/ttyUSB0 1 tests/conformance --rig ./rig --report report.txt
)",
     {"model", "rig", "report"},
     verify_module},
};

}  // namespace ex9000::utility
