// Finds what a scenario wants of a bus that lacks it, before anything is played.
#pragma once

#include "sim/play/bus_target.hpp"
#include "sim/play/transcript.hpp"

namespace ex9000::play {

/// Chooses modules and lines, looks for inputs and lets faults come and go as `scenario` says, in no time:
/// what depends on when it is said stays to be seen. `bus` is of no use for anything else then. Throws
/// std::invalid_argument that names file, line, step and what is wrong.
void rehearse(const Transcript& scenario, BusTarget& bus);

}  // namespace ex9000::play
