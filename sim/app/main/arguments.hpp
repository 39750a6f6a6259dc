// The command line of ex9000-sim.
#pragma once

#include <optional>
#include <string>

#include "sim/app/play/play.hpp"
#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// The exit status if an argument is wrong.
constexpr int kWrongArguments = 2;

/// Either a job to do, or text to print and an exit status.
struct Parsed {
  std::optional<Setup> setup;      ///< the lines to simulate
  std::optional<play::Task> task;  ///< the files to play
  std::string output;              ///< text for standard output
  std::string error;               ///< one line of text for standard error
  int exit_status = 0;
};

/// Control characters become blanks, but not at the end: an error is one line, and may quote newlines.
std::string one_line(std::string text);

/// Reads the bus file too. For wrong arguments, returns the error text and the exit status; does not throw.
Parsed parse_arguments(int argc, const char* const* argv);

}  // namespace ex9000::sim
