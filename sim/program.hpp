// ex9000-sim, from its command line to its exit status.
#pragma once

namespace ex9000::sim {

/// Does what the arguments say, until that is done or a signal asks for the end.
int run_program(int argc, const char* const* argv);

}  // namespace ex9000::sim
