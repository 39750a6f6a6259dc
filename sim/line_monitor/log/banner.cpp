#include "sim/line_monitor/log/banner.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "firmware/model/model.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// Returns the path as one word for the shell. Adds quotes if a character of the path is not in `plain`.
std::string quoted(const std::string& path) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+:@%";
  if (path.find_first_not_of(plain) == std::string::npos) {
    return path;
  }
  std::string text = "'";
  for (const char character : path) {
    text += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return text + "'";
}

/// The options that set a line format. A pseudo-terminal ignores the format, but a real bus does not.
struct FormatOptions {
  const char* mbpoll;   ///< for mbpoll, whose default is 8E1
  const char* picocom;  ///< for picocom, whose default is 8N1
};

const FormatOptions& options_of(LineFormat format) {
  static constexpr std::array<FormatOptions, 4> kInTheOrderOfLineFormat{
      {{" -P none", ""}, {" -P none -s 2", " -p 2"}, {" -P even", " -y e"}, {" -P odd", " -y o"}}};
  return kInTheOrderOfLineFormat[static_cast<std::size_t>(format)];
}

/// Returns commands for mbpoll, which counts coils, inputs and registers from 1. `port` is the path of a
/// pseudo-terminal or a host, and `options` are mbpoll's options for this connection.
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

/// Returns commands that a user can paste to use the module; empty if masters can reach the module neither
/// through a pseudo-terminal nor through the gateway.
std::string commands(const LineSummary& line, const ModuleSummary& module) {
  if (!line.pty.empty() && module.speaks_ascii) {
    return terminal(module, quoted(line.pty));
  }
  if (!line.pty.empty()) {
    const std::string baud = std::to_string(module.mode.baud);
    return mbpoll(module, "-m rtu -b " + baud + options_of(module.mode.format).mbpoll, quoted(line.pty));
  }
  if (line.modbus_tcp.empty() || module.speaks_ascii) {
    return "";
  }
  const auto colon = line.modbus_tcp.rfind(':');
  return mbpoll(module, "-m tcp -p " + line.modbus_tcp.substr(colon + 1), line.modbus_tcp.substr(0, colon));
}

std::string ports(const LineSummary& line) {
  std::string text;
  if (!line.pty.empty()) {
    text += "  pseudo-terminal " + quoted(line.pty) + " (" + line.pty_device + ")\n";
  }
  if (!line.tcp.empty()) {
    text += "  TCP " + line.tcp + ", raw bytes: Modbus RTU (not Modbus TCP) and ASCII\n";
  }
  if (!line.modbus_tcp.empty()) {
    text += "  Modbus TCP " + line.modbus_tcp + ", a gateway to the modules that speak Modbus RTU\n";
  }
  if (!line.serial.empty()) {
    text += "  serial port " + line.serial + "\n";
  }
  return text;
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

/// A gateway without a module that it can reach.
std::string useless_gateway(const LineSummary& line) {
  const bool useless = !line.modbus_tcp.empty() &&
                       std::all_of(line.modules.begin(), line.modules.end(),
                                   [](const ModuleSummary& module) { return module.speaks_ascii; });
  return useless ? "all modules speak ASCII, so each request over Modbus TCP gets exception 0A; use --tcp "
                   "for ASCII, "
                   "or -M models with the protocol modbus\n"
                 : "";
}

std::string introduction(const LineSummary& line) {
  std::string text = (line.name.empty() ? "line" : line.name) + " at " +
                     mode_text(line.mode.baud, line.mode.format) +
                     (line.instant ? ", bytes take no time" : "") + ":\n" + ports(line);
  for (const ModuleSummary& module : line.modules) {
    text += "  " + module.designation + " at " + hex_byte_text(module.address) + ", " +
            (module.speaks_ascii ? "ASCII" : "Modbus RTU") + ", " +
            mode_text(module.mode.baud, module.mode.format) +
            (module.remark.empty() ? "" : "; " + module.remark) + "\n";
    text += commands(line, module);
  }
  return text + shared_addresses(line.modules) + useless_gateway(line);
}

}  // namespace

std::string greeting(const BannerContent& all) {
  std::string text = all.panel.empty() ? "" : "panel: " + all.panel + "\n";
  text += "ex9000-sim " + std::string(kFirmwareVersion);
  text += all.lines.size() == 1 ? ", " : ":\n";
  for (const LineSummary& line : all.lines) {
    text += introduction(line);
  }
  if (!all.control.empty()) {
    text += "  control socket " + quoted(all.control) + "\n";
  }
  return text + "press Ctrl-C to end";
}

}  // namespace ex9000::sim
