// The texts that --help prints after the options.
#pragma once

#include <string>

namespace ex9000::sim::help {

/// Returns the syntax of modules, control commands, faults and inputs that change by themselves, and
/// examples.
std::string of_the_program();
/// Returns the syntax of the steps of transcripts and scenarios.
std::string of_play();
/// Returns examples of `describe`.
std::string of_describe();

}  // namespace ex9000::sim::help
