// What the program says first.
#pragma once

#include <string>

#include "sim/arguments.hpp"

namespace ex9000::sim {

/// The line, its modules, and commands to paste that poll each of them; several lines.
std::string greeting(const Arguments& arguments, const std::string& device);

}  // namespace ex9000::sim
