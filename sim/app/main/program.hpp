// Runs ex9000-sim, from its command line to its exit status.
#pragma once

namespace ex9000::sim {

/// Blocks until the work is done or a signal ends the program. Returns the exit status.
int run_program(int argc, const char* const* argv);

}  // namespace ex9000::sim
