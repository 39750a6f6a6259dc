// The program ex9000, apart from the computer that it runs on.
#pragma once

#include "sim/utility/console/environment.hpp"

namespace ex9000::utility {

/// Returns the exit status. Does not throw.
int run_program(int argc, const char* const* argv, Environment& environment);

}  // namespace ex9000::utility
