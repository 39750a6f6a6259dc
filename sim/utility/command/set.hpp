// `ex9000 set`, `address`, `save`, `restore`: the settings of modules.
#pragma once

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

bool set(Environment& environment, const sim::Words& args, const Options& options);
bool set_address_by_number(Environment& environment, const sim::Words& args, const Options& options);
bool save(Environment& environment, const sim::Words& args, const Options& options);
bool restore(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
