// `ex9000 scan`: which modules are on a line.
#pragma once

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

bool scan_line(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
