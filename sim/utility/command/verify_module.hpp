// `ex9000 verify`.
#pragma once

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

bool verify_module(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
