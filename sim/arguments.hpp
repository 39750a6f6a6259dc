// The command line of ex9000-sim.
#pragma once

#include <optional>
#include <string>

#include "sim/play/play.hpp"
#include "sim/setup.hpp"

namespace ex9000::sim {

/// Exit status where an argument is wrong.
constexpr int kWrongArguments = 2;

/// What the command line comes to: either something to do, or text to print and a status to exit with.
struct Parsed {
  std::optional<Setup> setup;      ///< to run
  std::optional<play::Task> task;  ///< to play
  std::string output;              ///< for standard output
  std::string error;               ///< one line for standard error
  int exit_status = 0;
};

/// `text` with a blank for every newline; arguments may hold them.
std::string one_line(std::string text);

Parsed parse_arguments(int argc, const char* const* argv);

}  // namespace ex9000::sim
