// The commands of the control socket: actions, and those that concern the whole program.
#pragma once

#include <string>
#include <utility>

#include "sim/notation/actions.hpp"

namespace ex9000::sim {

/// Without the socket and without `advance`. A command has no newline.
class Control {
 public:
  explicit Control(LinesInUse lines) : lines_(std::move(lines)) {}

  struct Reply {
    std::string text;  ///< `ok`, `ok ...` or `error: ...`, without a newline
    bool quit = false;
  };

  /// A rejected command changes nothing.
  Reply carry_out(const std::string& command);

 private:
  LinesInUse lines_;
};

}  // namespace ex9000::sim
