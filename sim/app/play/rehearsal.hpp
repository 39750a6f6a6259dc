// Finds modules, lines, inputs and faults that a scenario uses and the bus lacks, before the scenario is
// played.
#pragma once

#include "sim/app/play/bus_target.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::play {

/// Carries out the steps of `scenario` that choose modules and lines or add and remove faults, and checks
/// that the inputs in other steps exist. No virtual time passes, so errors that depend on time are not found.
/// `bus` must not be used for anything else afterwards. Throws std::invalid_argument that names the file, the
/// line, the step and what is wrong.
void rehearse(const Transcript& scenario, BusTarget& bus);

}  // namespace ex9000::play
