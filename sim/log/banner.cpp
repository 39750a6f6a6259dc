#include "sim/log/banner.hpp"

#include <map>

#include "firmware/model/model.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// Returns the path, in quotes if the shell requires them.
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

/// Returns the options of mbpoll, whose default is 8E1. A pseudo-terminal ignores the format, but a real bus
/// does not.
std::string mbpoll_format(LineFormat format) {
  switch (format) {
    case LineFormat::k8N1:
      return " -P none ";
    case LineFormat::k8N2:
      return " -P none -s 2 ";
    case LineFormat::k8E1:
      return " -P even ";
    case LineFormat::k8O1:
      return " -P odd ";
  }
  return " ";
}

/// Returns the options of picocom, whose default is 8N1.
std::string picocom_format(LineFormat format) {
  switch (format) {
    case LineFormat::k8N1:
      return "";
    case LineFormat::k8N2:
      return " -p 2";
    case LineFormat::k8E1:
      return " -y e";
    case LineFormat::k8O1:
      return " -y o";
  }
  return "";
}

/// Returns commands for mbpoll, which counts addresses from 1.
std::string mbpoll(const ModuleSummary& module, const std::string& link) {
  const std::string common = "mbpoll -m rtu -a " + std::to_string(module.address) + " -b " +
                             std::to_string(module.mode.baud) + mbpoll_format(module.mode.format);
  std::string text;
  if (module.outputs != 0) {
    text += "    " + common + "-t 0 -r 1 -c " + std::to_string(module.outputs) + " -1 " + link +
            "    # read the outputs\n";
    text += "    " + common + "-t 0 -r 1 " + link + " 1" + "    # switch output 0 on\n";
  }
  if (module.inputs != 0) {
    text += "    " + common + "-t 1 -r 1 -c " + std::to_string(module.inputs) + " -1 " + link +
            "    # read the inputs\n";
    text += "    " + common + "-t 3 -r 1 -c " + std::to_string(module.inputs) + " -1 " + link +
            "    # read the counters\n";
  }
  return text;
}

/// Returns a command for a terminal program.
std::string terminal(const ModuleSummary& module, const std::string& link) {
  return "    picocom -q -b " + std::to_string(module.mode.baud) + picocom_format(module.mode.format) +
         " --imap crcrlf --echo " + link + "    # then type $" + hex_byte_text(module.address) +
         "M and Enter\n";
}

std::string ports(const LineSummary& line) {
  std::string text;
  if (!line.pty.empty()) {
    text += "  pseudo-terminal " + quoted(line.pty) + " (" + line.pty_device + ")\n";
  }
  if (!line.tcp.empty()) {
    text += "  TCP " + line.tcp + ", the bytes as they are: Modbus RTU (not Modbus TCP) and ASCII\n";
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
              " and will reply at the same time; use MODEL@ADDR to give them different addresses\n";
    }
  }
  return text;
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
    if (!line.pty.empty()) {
      const std::string link = quoted(line.pty);
      text += module.speaks_ascii ? terminal(module, link) : mbpoll(module, link);
    }
  }
  return text + shared_addresses(line.modules);
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
