#include "sim/utility/command/help.hpp"

#include <algorithm>

#include "sim/text/help_row.hpp"
#include "sim/utility/device/property.hpp"

namespace ex9000::utility {

namespace {

constexpr std::size_t kColumn = 30;

struct Word {
  std::string_view name;
  std::string_view is;
};

/// Of the shapes of verbs.
constexpr Word kWords[] = {
    {"PORT",
     "a serial port, for example /dev/ttyUSB0, or a pseudo-terminal; tcp:HOST:PORT: the bytes of a line\n"
     "over TCP; modbus-tcp:HOST[:PORT]: a gateway"},
    {"MODULE", "an address, as 10 or 0x0A, or a serial number with 8 hex digits"},
    {"MODULES", "several, as 1-4,9,0D001F3A"},
    {"SERIAL", "a serial number with 8 hex digits"},
    {"ADDRESS", "the new address, 1 to 247"},
    {"KEY=VALUE...", "the settings, see below"},
    {"REQUEST...",
     "a DCON command without CR, in quotes, or the bytes of a Modbus request in hex, without the CRC"},
    {"FILE", "the file"},
    {"FILE...", "transcripts, or folders with transcripts"},
};

std::string row(const std::string& name, std::string_view does) { return sim::help_row(name, does, kColumn); }

std::string option_shape(const sim::Setting<Options>& option) {
  const std::string name = "--" + std::string(option.name);
  return option.form == sim::Form::Flag ? name : name + " " + std::string(option.value);
}

std::string keys() {
  std::string text = "\nThe settings:\n\n";
  for (const Property& property : properties) {
    text += row(std::string(property.key) + "=" + std::string(property.value), property.does);
  }
  return text;
}

constexpr std::string_view kHelp = "-h,--help";

}  // namespace

std::string program_help() {
  std::string text =
      "Finds, sets up, updates and verifies EX9000 modules on an RS-485 line.\n"
      "Usage: ex9000 [OPTIONS] SUBCOMMAND ...\n\nOptions:\n" +
      row(std::string(kHelp), "print this help, or that of a subcommand") +
      row("--version", "print the version") + "\nSubcommands:\n";
  for (const Verb& verb : verbs) {
    text += row(std::string(verb.name()), verb.does);
  }
  return text;
}

std::string help_of(const Verb& verb) {
  std::string text = std::string(verb.does) + "\nUsage: ex9000 " + std::string(verb.name()) + " [OPTIONS]" +
                     std::string(verb.shape.substr(verb.name().size())) + "\n\nPositionals:\n";
  const sim::Words shape = sim::words_of(std::string(verb.shape));
  for (const Word& word : kWords) {
    if (std::find(shape.begin(), shape.end(), word.name) != shape.end()) {
      text += row(std::string(word.name), word.is);
    }
  }
  text += "\nOptions:\n" + row(std::string(kHelp), "print this help");
  for (const sim::Setting<Options>& option : known_options) {
    if (verb.takes(option.name)) {
      text += row(option_shape(option), option.does);
    }
  }
  return text + std::string(verb.more) +
         (verb.shape.find("KEY=VALUE") == std::string_view::npos ? "" : keys());
}

}  // namespace ex9000::utility
