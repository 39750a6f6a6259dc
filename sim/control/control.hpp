// What can be done to a line's modules from outside, as commands of a line of text.
#pragma once

#include <string>

#include "sim/line.hpp"

namespace ex9000::sim {

/// The commands of `--control`, without the socket.
class Control {
 public:
  explicit Control(Line& line) : line_(line) {}

  struct Reply {
    std::string text;  ///< `ok`, `ok ...` or `error: ...`, without newline
    bool quit = false;
  };

  /// `command` is a line without its newline. Where it is refused nothing is changed.
  Reply carry_out(const std::string& command);

 private:
  Line& line_;
};

/// The commands and what they do, a line each, for --help and the manual.
std::string control_commands();

}  // namespace ex9000::sim
