#include "sim/utility/command/help.hpp"

#include <algorithm>

#include "sim/text/help_row.hpp"
#include "sim/utility/device/property.hpp"

namespace ex9000::utility {

namespace {

constexpr std::size_t kColumn = 30;

constexpr const char* kWords = R"(
PORT is a serial port, for example /dev/ttyUSB0, or a pseudo-terminal; tcp:HOST:PORT for the bytes of a
line over TCP; or modbus-tcp:HOST[:PORT] for a gateway.
MODULE is an address, as 10 or 0x0A, or a serial number with 8 hex digits; MODULES are several, as 1-4,9.
)";

std::string keys() {
  std::string text = "\nKEY=VALUE is one of:\n";
  for (const Property& property : properties) {
    text +=
        sim::help_row(std::string(property.key) + "=" + std::string(property.value), property.does, kColumn);
  }
  return text;
}

std::string shape_of(const sim::Setting<Options>& option) {
  const std::string name = "--" + std::string(option.name);
  return option.form == sim::Form::Flag ? name : name + " " + std::string(option.value);
}

}  // namespace

std::string program_help() {
  std::string text =
      "Finds, sets up, updates and verifies EX9000 modules on an RS-485 line.\n"
      "Usage: ex9000 COMMAND ARGUMENTS [OPTIONS]\n\nCommands:\n";
  for (const Verb& verb : verbs) {
    text += sim::help_row(std::string(verb.shape), verb.does, kColumn);
  }
  text += "\nOptions:\n" + sim::help_row("-h,--help", "print this help, or that of a command", kColumn) +
          sim::help_row("--version", "print the version", kColumn);
  return text + kWords;
}

std::string help_of(const Verb& verb) {
  std::string text = "Usage: ex9000 " + std::string(verb.shape) + " [OPTIONS]\n\n" + std::string(verb.does) +
                     "\n" + std::string(verb.more) + "\nOptions:\n";
  for (const sim::Setting<Options>& option : known_options) {
    if (verb.takes(option.name)) {
      text += sim::help_row(shape_of(option), option.does, kColumn);
    }
  }
  return text + (verb.shape.find("KEY=VALUE") == std::string_view::npos ? "" : keys()) + kWords;
}

}  // namespace ex9000::utility
