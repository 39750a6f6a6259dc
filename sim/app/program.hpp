// Runs ex9000-sim, from its command line to its exit status.
#pragma once

namespace ex9000::sim {

/// Does what the arguments say. Returns the exit status when the work is done or a signal requests the end.
int run_program(int argc, const char* const* argv);

}  // namespace ex9000::sim
