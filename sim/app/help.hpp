// The texts that --help prints after the options.
#pragma once

#include <string>

namespace ex9000::sim::help {

/// The modules, the control commands, the faults and examples.
std::string of_the_program();
/// The steps of transcripts and scenarios.
std::string of_play();
/// Examples.
std::string of_describe();

}  // namespace ex9000::sim::help
