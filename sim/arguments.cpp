#include "sim/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>

namespace ex9000::sim {

namespace {

constexpr const char* kDescription =
    "Simulated EX9000 modules on one RS-485 line, on a pseudo-terminal that a Modbus or DCON master opens.";

constexpr const char* kFooter = R"(
A module is MODEL[@ADDR][,KEY=VALUE]...: MODEL as --models lists it, upper or lower case, with or without EX;
ADDR in hex as in `$AA2` (01 if left out); the keys:
  protocol=ascii|modbus    what it speaks; -M models leave the factory with modbus
  baud=RATE                1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200
  checksum=on|off          of ASCII commands
  edge=falling|rising      what its counters count
  name=TEXT                what $AAM answers
  init=on|off              INIT* tied to GND: ASCII at address 00, 9600 baud

Example: ex9000-sim EX9042D-M@01 EX9052D-M@02,edge=rising 9068d-m@0A,protocol=ascii --log
The rate that a master sets on the pseudo-terminal is the line's rate.)";

std::string list_models() {
  std::string text;
  for (const Model& model : kModels) {
    std::string name(model.designation);
    name.resize(12, ' ');
    text += name + (model.speaks_modbus() ? "ASCII, Modbus RTU  " : "ASCII              ") +
            std::string(model.description) + "\n";
  }
  return text;
}

std::uint32_t parse_line_baud(const std::string& text) {
  for (const std::uint32_t rate : kBaudRates) {
    if (text == std::to_string(rate)) {
      return rate;
    }
  }
  throw std::invalid_argument("--baud " + text +
                              ": wants 1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
}

/// CLI11's own words may have several lines, and so may an argument.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') {
    text.pop_back();
  }
  return text;
}

Parsed wrong(const std::string& what) {
  Parsed parsed;
  parsed.error = "ex9000-sim: " + one_line(what) + "\n";
  parsed.exit_status = kWrongArguments;
  return parsed;
}

}  // namespace

Parsed parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kDescription, "ex9000-sim");
  app.footer(kFooter);
  Arguments arguments;
  std::vector<std::string> modules;
  std::string baud;
  bool models = false;
  app.add_option("MODULE", modules, "modules on the line, one after the other");
  app.add_option("--pty", arguments.pty_link, "make a pseudo-terminal and link it at this path")
      ->type_name("LINK")
      ->capture_default_str();
  app.add_option("--baud", baud, "the line's rate until a master sets one (default: the first module's)")
      ->type_name("RATE");
  app.add_flag("--log", arguments.log, "print the bus, a line a frame: time, direction, bytes, meaning");
  app.add_flag("--strict-gaps", arguments.strict_gaps,
               "Modbus to the letter: a gap of more than 1.5 characters spoils a frame, and a master that "
               "does not wait 3.5 characters between frames is on its own");
  app.add_flag("--models", models, "list the models and exit");
  app.set_version_flag("--version", "ex9000-sim " + std::string(kFirmwareVersion));
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    Parsed parsed;
    parsed.output = app.help();
    return parsed;
  } catch (const CLI::CallForVersion& version) {
    Parsed parsed;
    parsed.output = std::string(version.what()) + "\n";
    return parsed;
  } catch (const CLI::ParseError& error) {
    return wrong(std::string(error.what()) + "; --help tells more");
  }
  if (models) {
    Parsed parsed;
    parsed.output = list_models();
    return parsed;
  }
  try {
    if (app.count("--baud") != 0) {
      arguments.baud = parse_line_baud(baud);
    }
    for (const std::string& module : modules) {
      arguments.modules.push_back(parse_module_spec(module));
    }
  } catch (const std::invalid_argument& error) {
    return wrong(error.what());
  }
  if (arguments.modules.empty()) {
    return wrong("no module given; try 'ex9000-sim EX9042D-M' or --help");
  }
  if (arguments.pty_link.empty()) {
    return wrong("--pty: wants a path");
  }
  Parsed parsed;
  parsed.arguments = arguments;
  return parsed;
}

}  // namespace ex9000::sim
