// What can be done to lines and their modules from outside, as commands of a line of text.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/line.hpp"

namespace ex9000::sim {

/// On an input at once: some milliseconds of work.
constexpr unsigned long kMostPulses = 1'000'000;

/// The commands of `--control`, without the socket.
class Control {
 public:
  struct ControlledLine {
    std::string name;  ///< may be empty where there is but one
    Line& line;
    std::function<std::uint64_t()> sent = nullptr;  ///< bytes written to its ports so far; null: it has none
  };

  /// Modules are numbered from 1, through all `lines`.
  explicit Control(std::vector<ControlledLine> lines) : lines_(std::move(lines)) {}

  struct Reply {
    std::string text;  ///< `ok`, `ok ...` or `error: ...`, without newline
    bool quit = false;
  };

  /// `command` is a line without its newline. Where it is refused nothing is changed.
  Reply carry_out(const std::string& command);

 private:
  std::vector<ControlledLine> lines_;
};

/// The commands and what they do, a line each, for --help and the manual.
std::string control_commands();

}  // namespace ex9000::sim
