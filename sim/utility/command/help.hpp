// The help texts, from the tables of commands and options.
#pragma once

#include <string>

#include "sim/utility/command/verb.hpp"

namespace ex9000::utility {

std::string program_help();
std::string help_of(const Verb& verb);

}  // namespace ex9000::utility
