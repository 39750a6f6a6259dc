// `ex9000 show`, `poll`: what a module is and does.
#pragma once

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

bool show(Environment& environment, const sim::Words& args, const Options& options);
bool poll(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
