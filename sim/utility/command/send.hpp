// `ex9000 send`: one request, as the user writes it, and its reply in words.
#pragma once

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

bool send(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
