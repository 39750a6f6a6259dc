#include "sim/utility/command/show.hpp"

#include "sim/text/values.hpp"
#include "sim/utility/command/opened.hpp"
#include "sim/utility/device/fact.hpp"
#include "sim/utility/device/property.hpp"

namespace ex9000::utility {

namespace {

constexpr std::size_t kValueColumn = 20;

std::string row(std::string_view name, const std::string& value) {
  std::string text = "  " + std::string(name);
  text.resize(std::max(text.size() + 1, kValueColumn), ' ');
  return text + value + "\n";
}

/// "" if the module does not have it.
template <class Row>
std::string value_of(const Row& row, Opened& opened) {
  try {
    return meets(*opened.model, row.needs) ? row.read(opened.device, *opened.model) : "";
  } catch (const Absent&) {
    return "";
  }
}

/// In one line.
std::string present_state(Opened& opened) {
  std::string text;
  try {
    if (!opened.device.replies()) {
      return "no reply";
    }
    for (const Fact& fact : facts) {
      const std::string value = fact.changes ? value_of(fact, opened) : "";
      text += value.empty() ? "" : (text.empty() ? "" : "  ") + std::string(fact.name) + " " + value;
    }
  } catch (const Failed& error) {
    return error.what();
  }
  return text;
}

std::string head(Opened& opened) {
  const Identity& identity = opened.identity;
  std::string text = std::string(opened.model->designation) + " '" + identity.name + "'";
  text += identity.version.empty() ? "" : ", firmware " + identity.version;
  text += identity.serial_number ? ", serial number " + sim::hex_long_text(*identity.serial_number) : "";
  text += opened.device.speaks_modbus() ? ", Modbus" : ", ASCII";
  const hal::SerialMode mode = opened.line().mode();
  return text + (opened.line().has_modes() ? " at " + sim::mode_text(mode.baud, mode.format) : "") + "\n";
}

}  // namespace

bool show(Environment& environment, const sim::Words& args, const Options& options) {
  MasterLine line(environment, parse_port(args[0]), options.line);
  Opened opened(environment, line, args[1], options);
  environment.output << head(opened) << "settings\n";
  sim::Words warnings;
  std::map<std::string_view, std::string> values;
  for (const Property& property : properties) {
    const std::string value = value_of(property, opened);
    if (!value.empty()) {
      environment.output << row(property.key, value);
      values[property.key] = value;
    }
  }
  if (values["watchdog"] == "on" && values.count("safe-value") != 0 &&
      std::stoul(values["safe-value"], nullptr, 16) == 0) {
    warnings.emplace_back(
        "the host watchdog is on, and the safe value is 0: a timeout switches all outputs off");
  }
  const hal::SerialMode mode = opened.line().mode();
  const bool other_format = opened.line().connection().has_formats() && values["format"] != "8N2" &&
                            values["format"] != sim::line_format_text(mode.format);
  if (opened.line().has_modes() && (values["baud"] != std::to_string(mode.baud) || other_format)) {
    warnings.push_back("from the next reset on, it speaks at " + values["baud"] + " baud " +
                       values["format"]);
  }
  environment.output << "state\n";
  for (const Fact& fact : facts) {
    const std::string value = value_of(fact, opened);
    if (value.empty()) {
      continue;
    }
    environment.output << row(fact.name, value);
    if (const std::string warning = fact.warning == nullptr ? "" : fact.warning(value); !warning.empty()) {
      warnings.push_back(warning);
    }
  }
  for (const std::string& warning : warnings) {
    environment.output << "warning: " << warning << "\n";
  }
  environment.output << std::flush;
  return true;
}

bool poll(Environment& environment, const sim::Words& args, const Options& options) {
  const sim::Words names = expand_modules({args[1]});
  MasterLine line(environment, parse_port(args[0]), options.line);
  std::vector<Opened> modules;
  for (const std::string& name : names) {
    try {
      modules.emplace_back(environment, line, name, options);
    } catch (const Failed& error) {
      if (names.size() == 1) {
        throw;
      }
      environment.error << error.what() << std::endl;
    }
  }
  if (modules.empty()) {
    throw Failed("there is no module to poll");
  }
  const bool in_place = environment.output_is_terminal;
  const char* const begin = in_place ? "\033[?7l" : "";      // a long line is cut
  const char* const end = in_place ? "\033[K\033[?7h" : "";  // what has been in the rest of the line goes
  for (std::uint32_t round = 0; options.rounds == 0 || round < options.rounds; ++round) {
    if (round != 0) {
      line.connection().pause(options.every);
      if (in_place) {
        environment.output << "\033[" << modules.size() << "A";  // up
      }
    }
    for (Opened& module : modules) {
      const std::string lead = modules.size() == 1 ? "" : module.device.name() + ": ";
      const std::string state = present_state(module);  // may be interrupted
      environment.output << begin << lead << state << end << std::endl;
    }
    environment.check_output();
  }
  return true;
}

}  // namespace ex9000::utility
