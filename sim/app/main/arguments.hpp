// The command line of ex9000-sim.
#pragma once

#include <optional>
#include <string>

#include "sim/app/play/play.hpp"
#include "sim/app/setup/setup.hpp"
#include "sim/text/error_line.hpp"

namespace ex9000::sim {

/// Either a job to do, or text to print and an exit status.
struct Parsed {
  std::optional<Setup> setup;      ///< the lines to simulate
  std::optional<play::Task> task;  ///< the files to play
  std::string output;              ///< text for standard output
  std::string error;               ///< one line of text for standard error
  int exit_status = 0;
};

/// Reads the bus file too. For wrong arguments, returns the error text and the exit status; does not throw.
Parsed parse_arguments(int argc, const char* const* argv);

}  // namespace ex9000::sim
