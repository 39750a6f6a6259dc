// Commands that act on lines and their modules from outside. Each command is a text without a newline.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// The largest number of pulses on an input in one command. The program needs tens of milliseconds for them.
constexpr unsigned long kMostPulses = 1'000'000;

/// The commands of `--control`, without the socket and without `advance`.
class Control {
 public:
  struct ControlledLine {
    std::string name;  ///< may be empty if there is only one line
    Line& line;
    /// Returns the number of bytes written to each port of the line so far, including dropped bytes; null:
    /// the line has no ports.
    std::function<std::uint64_t()> sent = nullptr;
    bool has_serial_port = false;  ///< if true, commands cannot change the line's rate or format
  };

  /// Modules are numbered from 1 across all `lines`.
  explicit Control(std::vector<ControlledLine> lines) : lines_(std::move(lines)) {}

  struct Reply {
    std::string text;  ///< `ok`, `ok ...` or `error: ...`, without a newline
    bool quit = false;
  };

  /// Carries out a command and returns the reply. A rejected command changes nothing.
  Reply carry_out(const std::string& command);

 private:
  std::vector<ControlledLine> lines_;
};

/// Returns the commands and what they do, for --help. The text has several lines.
std::string control_commands();

}  // namespace ex9000::sim
