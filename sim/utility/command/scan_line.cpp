#include "sim/utility/command/scan_line.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "sim/text/values.hpp"
#include "sim/utility/console/progress.hpp"
#include "sim/utility/scan/scan.hpp"

namespace ex9000::utility {

namespace {

const char* protocol_text(const FoundModule& module) {
  return module.speaks == Speaks::Ascii ? "ascii" : "modbus";
}

std::string serial_number_text(const FoundModule& module) {
  return module.identity.serial_number ? sim::hex_long_text(*module.identity.serial_number) : "";
}

/// After a blank; empty if it is not known.
std::string mode_of(const FoundModule& module) {
  return module.mode ? " " + sim::mode_text(module.mode->baud, module.mode->format) : "";
}

std::string line_of(const FoundModule& module) {
  std::string text = std::to_string(module.address) + " (" + sim::hex_byte_text(module.address) + ")  " +
                     protocol_text(module) + mode_of(module) + (module.checksum ? " checksum" : "");
  if (module.garbled) {
    return text + "  bytes, but no reply: several modules with this address, or noise";
  }
  text += "  " + (module.identity.model_text.empty() ? "unknown model" : module.identity.model_text);
  text += " '" + module.identity.name + "'";
  for (const std::string& more : {module.identity.version, serial_number_text(module)}) {
    text += more.empty() ? "" : "  " + more;
  }
  text += module.last_reset.empty() ? "" : "  last reset: " + module.last_reset;
  if (module.stored_address) {
    text += "  INIT* is tied to GND; stored address " + std::to_string(*module.stored_address);
  }
  return text;
}

std::string json_of(const FoundModule& module) {
  nlohmann::ordered_json json{{"address", module.address}, {"protocol", protocol_text(module)}};
  if (module.mode) {
    json["baud"] = module.mode->baud;
    json["format"] = sim::line_format_text(module.mode->format);
  }
  if (module.speaks == Speaks::Ascii) {
    json["checksum"] = module.checksum;
  }
  for (const auto& [key, value] : {std::pair("model", module.identity.model_text),
                                   {"name", module.identity.name},
                                   {"version", module.identity.version},
                                   {"serial-number", serial_number_text(module)},
                                   {"last-reset", module.last_reset}}) {
    if (!value.empty()) {
      json[key] = value;
    }
  }
  if (module.stored_address) {
    json["stored-address"] = *module.stored_address;
  }
  if (module.garbled) {
    json["garbled"] = true;
  }
  return json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

/// `FIRST-LAST` or one address.
void parse_addresses(const std::string& text, Search& search) {
  const std::size_t dash = text.find('-');
  search.first = parse_address(text.substr(0, dash));
  search.last = dash == std::string::npos ? search.first : parse_address(text.substr(dash + 1));
  if (search.first > search.last) {
    sim::fail("--addresses: '" + text + "': expected FIRST-LAST, as 1-32");
  }
}

/// Of the modules that have an address in common.
void report_duplicates(Environment& environment, const std::vector<FoundModule>& modules) {
  std::map<std::tuple<std::string, Speaks, unsigned>, unsigned> counts;
  for (const FoundModule& module : modules) {
    counts[{mode_of(module), module.speaks, module.address}] += module.garbled ? 0 : 1;
  }
  for (const auto& [place, count] : counts) {
    const auto& [mode, speaks, address] = place;
    if (count > 1) {
      environment.error << count << " modules have the address " << address << (mode.empty() ? "" : " at")
                        << mode << "; give each its own with 'ex9000 address PORT SERIAL ADDRESS'"
                        << std::endl;
    }
  }
}

}  // namespace

Search search_of(MasterLine& line, const Options& options) {
  if (options.fast && options.speaks == Speaks::Ascii) {
    sim::fail("--fast: modules in ASCII have no such scan; leave out one of --fast and --ascii");
  }
  Search search;
  // A module in 8N2 understands 8N1.
  const LineFormat wanted = options.line.format == LineFormat::k8N2 ? LineFormat::k8N1 : options.line.format;
  for (const hal::SerialMode mode : line.has_modes() ? all_modes() : std::vector{options.line}) {
    const bool rate_wanted = !options.is_given("baud") || mode.baud == options.line.baud;
    const bool format_wanted = options.is_given("format")
                                   ? mode.format == wanted
                                   : line.connection().has_formats() || mode.format == LineFormat::k8N1;
    if (rate_wanted && format_wanted) {
      search.modes.push_back(mode);
    }
  }
  if (search.modes.empty()) {
    search.modes.push_back(options.line);
  }
  search.speaks = options.speaks;
  search.fast = options.fast;
  search.patience = options.timeout;
  if (!options.addresses.empty()) {
    parse_addresses(options.addresses, search);
  }
  return search;
}

std::vector<FoundModule> print_modules(Environment& environment, MasterLine& line, const Search& search,
                                       bool json) {
  std::vector<FoundModule> modules;
  Progress progress(environment, "scan");
  scan(
      line, search,
      [&](const FoundModule& module) {
        modules.push_back(module);
        progress.clear();
        environment.output << (json ? json_of(module) : line_of(module)) << std::endl;
        environment.check_output();
      },
      [&](std::size_t done, std::size_t of) { progress.show(done, of); });
  report_duplicates(environment, modules);
  if (modules.empty()) {
    environment.error << "no module replies; check the supply and the wires A and B"
                      << (search.fast ? ", or leave out --fast" : "") << std::endl;
  }
  return modules;
}

bool scan_line(Environment& environment, const sim::Words& args, const Options& options) {
  const Port port = parse_port(args[0]);
  if (port.kind == Port::Kind::ModbusTcp && (options.fast || options.speaks == Speaks::Ascii)) {
    sim::fail("Modbus TCP carries neither DCON nor a scan by serial numbers; leave out --fast and --ascii");
  }
  MasterLine line(environment, port, options.line);
  return !print_modules(environment, line, search_of(line, options), options.json).empty();
}

}  // namespace ex9000::utility
