// `ex9000 panel`: the modules of a line in a browser.
#pragma once

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

bool panel(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
