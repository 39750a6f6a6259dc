// The command line of ex9000-sim.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/module_spec.hpp"

namespace ex9000::sim {

struct Arguments {
  std::vector<ModuleSpec> modules;  ///< at least one
  std::string pty_link = "ex9000.tty";
  std::optional<std::uint32_t> baud;  ///< of the line, until a master sets one
  bool log = false;
  bool strict_gaps = false;

  /// The line's rate at the start, bits per second.
  [[nodiscard]] std::uint32_t line_baud() const { return baud.value_or(modules.front().baud()); }
};

/// Exit status where an argument is wrong.
constexpr int kWrongArguments = 2;

/// What the command line comes to: either something to do, or text to print and a status to exit with.
struct Parsed {
  std::optional<Arguments> arguments;
  std::string output;  ///< for standard output
  std::string error;   ///< one line for standard error
  int exit_status = 0;
};

Parsed parse_arguments(int argc, const char* const* argv);

}  // namespace ex9000::sim
