#include "sim/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "sim/control/control.hpp"
#include "sim/reference.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kDescription =
    "Simulated EX9000 modules on one RS-485 line, for Modbus and DCON masters: on a pseudo-terminal, over "
    "TCP, "
    "or on a real serial port.";

constexpr const char* kDefaultPty = "ex9000.tty";

constexpr const char* kModuleHelp = R"(
A module is MODEL[@ADDR][,KEY=VALUE]...: MODEL as --models lists it, upper or lower case, with or without EX;
ADDR in hex as in `$AA2` (01 if left out); the keys:
  protocol=ascii|modbus    what it speaks; -M models leave the factory with modbus
  baud=RATE                1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200
  checksum=on|off          of ASCII commands
  edge=falling|rising      what its counters count
  name=TEXT                what $AAM answers
  init=on|off              INIT* tied to GND: ASCII at address 00, 9600 baud
  eeprom=FILE              keeps its settings there, made if missing; what it holds wins over those given here

Commands on the control socket, a line each, answered with `ok ...` or `error: ...`; N is a module's position
on the command line, from 1:
)";

constexpr const char* kExamples = R"(
Examples:
  ex9000-sim EX9042D-M@01 EX9052D-M@02,edge=rising 9068d-m@0A,protocol=ascii --log
  ex9000-sim EX9042D-M@01,eeprom=pump.bin --tcp 5020 --control pump.ctl
The rate that a master sets on the pseudo-terminal is the line's rate.)";

std::string footer() { return kModuleHelp + control_commands() + kExamples; }

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

/// Whether it is instant.
bool parse_line_kind(const std::string& text) {
  if (text != "paced" && text != "instant") {
    throw std::invalid_argument("--line " + text + ": wants paced or instant");
  }
  return text == "instant";
}

Parsed wrong(const std::string& what) {
  Parsed parsed;
  parsed.error = "ex9000-sim: " + one_line(what) + "\n";
  parsed.exit_status = kWrongArguments;
  return parsed;
}

/// What is not understood by CLI11 itself.
struct Texts {
  std::vector<std::string> modules;
  std::optional<std::string> tcp;
  std::optional<std::string> baud;
  std::optional<std::string> line;
};

void check_paths(const Arguments& arguments) {
  for (const auto& [option, path] :
       {std::pair("--pty", arguments.pty), std::pair("--serial", arguments.serial),
        std::pair("--control", arguments.control)}) {
    if (path && path->empty()) {
      throw std::invalid_argument(std::string(option) + ": wants a path");
    }
  }
  std::set<std::string> files;
  for (const ModuleSpec& module : arguments.modules) {
    if (!module.eeprom.empty() && !files.insert(module.eeprom).second) {
      throw std::invalid_argument("eeprom=" + module.eeprom +
                                  ": two modules cannot share one; name a file for each");
    }
  }
}

/// Throws std::invalid_argument, one line.
void take(const Texts& texts, Arguments& arguments) {
  if (texts.baud) {
    arguments.baud = parse_line_baud(*texts.baud);
  }
  if (texts.line) {
    arguments.instant = parse_line_kind(*texts.line);
  }
  if (texts.tcp) {
    arguments.tcp = parse_tcp_address(*texts.tcp);
  }
  for (const std::string& module : texts.modules) {
    arguments.modules.push_back(parse_module_spec(module));
  }
  if (arguments.modules.empty()) {
    throw std::invalid_argument("no module given; try 'ex9000-sim EX9042D-M' or --help");
  }
  if (arguments.serial && (arguments.pty || arguments.tcp)) {
    throw std::invalid_argument("--serial: the master is on that line; leave out --pty and --tcp");
  }
  if (arguments.echo && !arguments.serial) {
    throw std::invalid_argument("--echo: only a serial port may have one; --serial names it");
  }
  if (arguments.instant && arguments.serial) {
    throw std::invalid_argument(
        "--line instant: on a real line bytes take their time; leave it out with --serial");
  }
  if (arguments.instant && arguments.strict_gaps) {
    throw std::invalid_argument(
        "--strict-gaps: gaps mean nothing with --line instant; leave one of them out");
  }
  if (!arguments.pty && !arguments.tcp && !arguments.serial) {
    arguments.pty = kDefaultPty;
  }
  check_paths(arguments);
}

/// Of all models where none is named.
Parsed print_reference(const std::string& model) {
  try {
    Parsed parsed;
    parsed.output = model.empty() ? reference() : reference(model_called(model));
    return parsed;
  } catch (const std::invalid_argument& error) {
    return wrong(std::string("--reference: ") + error.what());
  }
}

}  // namespace

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') {
    text.pop_back();
  }
  return text;
}

Parsed parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kDescription, "ex9000-sim");
  app.footer(footer());
  Arguments arguments;
  Texts texts;
  bool models = false;
  std::string reference_of;
  app.add_option("MODULE", texts.modules, "modules on the line, one after the other");
  app.add_option("--pty", arguments.pty,
                 std::string("make a pseudo-terminal and link it at this path (default: ") + kDefaultPty +
                     ", where neither --tcp nor --serial is given)")
      ->type_name("LINK");
  app.add_option("--tcp", texts.tcp, "serve the line's bytes over TCP; HOST is 127.0.0.1 if left out")
      ->type_name("HOST:PORT");
  app.add_option("--serial", arguments.serial, "put the modules on this serial port, behind a real line")
      ->type_name("DEVICE");
  app.add_flag("--echo", arguments.echo, "the serial port's adapter hears what it sends");
  app.add_option("--baud", texts.baud,
                 "the line's rate until a master sets one (default: the first module's)")
      ->type_name("RATE");
  app.add_option("--line", texts.line,
                 "paced (default): bytes take their time; instant: they cost none, for tests and load")
      ->type_name("paced|instant");
  app.add_option("--control", arguments.control, "make a UNIX socket at this path that takes commands")
      ->type_name("PATH");
  app.add_flag("--log", arguments.log, "print the bus, a line a frame: time, direction, bytes, meaning");
  app.add_flag("--strict-gaps", arguments.strict_gaps,
               "Modbus to the letter: a gap of more than 1.5 characters spoils a frame, and a master that "
               "does not wait 3.5 characters between frames is on its own");
  app.add_flag("--models", models, "list the models and exit");
  app.add_option("--reference", reference_of,
                 "print the commands and registers of this model, or of all models, and exit")
      ->type_name("[MODEL]")
      ->expected(0, 1);
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
  if (app.count("--reference") != 0) {
    return print_reference(reference_of);
  }
  try {
    take(texts, arguments);
  } catch (const std::invalid_argument& error) {
    return wrong(error.what());
  }
  Parsed parsed;
  parsed.arguments = arguments;
  return parsed;
}

}  // namespace ex9000::sim
