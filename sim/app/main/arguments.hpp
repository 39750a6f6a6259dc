// The command line of ex9000-sim.
#pragma once

#include <optional>
#include <string>

#include "sim/app/play/play.hpp"
#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// The exit status if an argument is wrong.
constexpr int kWrongArguments = 2;

/// The result of parsing the command line: either a job to do, or text to print and an exit status.
struct Parsed {
  std::optional<Setup> setup;      ///< the lines to simulate
  std::optional<play::Task> task;  ///< the files to play
  std::string output;              ///< text for standard output
  std::string error;               ///< one line of text for standard error
  int exit_status = 0;
};

/// Returns `text` with a blank in place of each control character, and without blanks at the end. An error
/// message must be one line, but the arguments that it quotes may contain newlines.
std::string one_line(std::string text);

/// Parses the command line, and reads the bus file if the command line names one. Wrong arguments do not
/// cause an exception: the result then has the error text and the exit status.
Parsed parse_arguments(int argc, const char* const* argv);

}  // namespace ex9000::sim
