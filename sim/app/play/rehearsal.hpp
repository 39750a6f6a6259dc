// Finds errors in a scenario before it is played: modules, lines and inputs that the bus lacks, and fault
// commands that the bus rejects.
#pragma once

#include "sim/app/play/line_target.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::play {

/// Carries out the steps of `scenario` that choose a module or a line or contain a fault command, and checks
/// that the inputs in other steps exist. No virtual time passes, so an error in the state of a module is not
/// one here (NotNow). `bus` must not be used for anything else afterwards. If a step is wrong, throws
/// std::invalid_argument that names the file, the line number, the step and what is wrong.
void rehearse(const Transcript& scenario, LineTarget& bus);

}  // namespace ex9000::play
