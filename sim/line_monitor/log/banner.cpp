#include "sim/line_monitor/log/banner.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "firmware/model/model.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

/// A pseudo-terminal ignores the format, but a real bus does not.
struct FormatOptions {
  const char* mbpoll;   ///< for mbpoll, whose default is 8E1
  const char* picocom;  ///< for picocom, whose default is 8N1
};

const FormatOptions& options_of(LineFormat format) {
  static constexpr std::array<FormatOptions, 4> kInTheOrderOfLineFormat{
      {{" -P none", ""}, {" -P none -s 2", " -p 2"}, {" -P even", " -y e"}, {" -P odd", " -y o"}}};
  return kInTheOrderOfLineFormat[static_cast<std::size_t>(format)];
}

/// mbpoll counts from 1. `port`: a pseudo-terminal or a host; `options`: for this connection.
std::string mbpoll(const ModuleSummary& module, const std::string& options, const std::string& port) {
  const std::string common = "    mbpoll " + options + " -a " + std::to_string(module.address);
  const auto read = [&](const char* type, unsigned count, const char* what) {
    return common + " -t " + type + " -r 1 -c " + std::to_string(count) + " -1 " + port + "    # read the " +
           what + "\n";
  };
  std::string text;
  if (module.outputs != 0) {
    text += read("0", module.outputs, "outputs");
    text += common + " -t 0 -r 1 " + port + " 1    # switch output 0 on\n";
  }
  if (module.inputs != 0) {
    text += read("1", module.inputs, "inputs");
    text += read("3", module.inputs, "counters");
  }
  return text;
}

std::string terminal(const ModuleSummary& module, const std::string& link) {
  return "    picocom -q -b " + std::to_string(module.mode.baud) + options_of(module.mode.format).picocom +
         " --imap crcrlf --echo " + link + "    # then type $" + hex_byte_text(module.address) +
         "M and Enter\n";
}

/// Empty if masters reach the module neither through a pseudo-terminal nor through the gateway.
std::string commands(const LineSummary& line, const ModuleSummary& module) {
  if (const PortSummary* pty = line.port("pty")) {
    const std::string link = shell_word(pty->address);
    return module.speaks_ascii ? terminal(module, link)
                               : mbpoll(module,
                                        "-m rtu -b " + std::to_string(module.mode.baud) +
                                            options_of(module.mode.format).mbpoll,
                                        link);
  }
  const PortSummary* gateway = line.port("modbus-tcp");
  if (gateway == nullptr || module.speaks_ascii) {
    return "";
  }
  const auto colon = gateway->address.rfind(':');
  return mbpoll(module, "-m tcp -p " + gateway->address.substr(colon + 1), gateway->address.substr(0, colon));
}

std::string shared_addresses(const std::vector<ModuleSummary>& modules) {
  std::map<unsigned, unsigned> users;
  for (const ModuleSummary& module : modules) {
    ++users[module.address];
  }
  std::string text;
  for (const auto& [address, count] : users) {
    if (count > 1) {
      text += std::to_string(count) + " modules are at address " + hex_byte_text(address) +
              " and may reply at the same time; give them different addresses with MODEL@ADDR, or with "
              "'address' in the bus file\n";
    }
  }
  return text;
}

/// It cannot reach any module.
std::string useless_gateway(const LineSummary& line) {
  const bool useless = line.port("modbus-tcp") != nullptr &&
                       std::all_of(line.modules.begin(), line.modules.end(),
                                   [](const ModuleSummary& module) { return module.speaks_ascii; });
  return useless ? "all modules speak ASCII, so each request over Modbus TCP gets exception 0A; use --port "
                   "tcp:... for ASCII, "
                   "or -M models with the protocol modbus\n"
                 : "";
}

std::string summary_of(const LineSummary& line) {
  std::string text = (line.name.empty() ? "line" : line.name) + " at " +
                     mode_text(line.mode.baud, line.mode.format) +
                     (line.instant ? ", bytes take no time" : "") + ":\n";
  for (const PortSummary& port : line.ports) {
    text += "  " + port.does + "\n";
  }
  for (const ModuleSummary& module : line.modules) {
    text += "  " + module.designation + " at " + hex_byte_text(module.address) + ", " +
            (module.speaks_ascii ? "ASCII" : "Modbus RTU") + ", " +
            mode_text(module.mode.baud, module.mode.format) +
            (module.serial_number == 0 ? "" : ", serial number " + hex_long_text(module.serial_number)) +
            (module.remark.empty() ? "" : "; " + module.remark) + "\n";
    text += commands(line, module);
  }
  return text + shared_addresses(line.modules) + useless_gateway(line);
}

}  // namespace

const PortSummary* LineSummary::port(const std::string& kind) const {
  const auto found =
      std::find_if(ports.begin(), ports.end(), [&](const PortSummary& port) { return port.kind == kind; });
  return found == ports.end() ? nullptr : &*found;
}

std::string greeting(const BannerContent& all) {
  std::string text = all.panel.empty() ? "" : "panel: " + all.panel + "\n";
  text += "ex9000-sim " + std::string(kFirmwareVersion);
  text += all.lines.size() == 1 ? ", " : ":\n";
  for (const LineSummary& line : all.lines) {
    text += summary_of(line);
  }
  if (!all.control.empty()) {
    text += "  control socket " + shell_word(all.control) + "\n";
  }
  return text + "press Ctrl-C to end";
}

}  // namespace ex9000::sim
