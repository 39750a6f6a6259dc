// Finds what a scenario uses and the bus lacks or rejects, before it is played.
#pragma once

#include "sim/app/play/line_target.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::play {

/// Carries out the steps that choose a module or a line or contain a fault command, and checks that the
/// inputs in other steps exist. No virtual time passes, so an error in the state of a module is not one here
/// (NotNow). Uses `bus` up. An error names the file, the line number and the step.
void rehearse(const Transcript& scenario, LineTarget& bus);

}  // namespace ex9000::play
