// The commands and registers, for programs.
#pragma once

#include <string>

#include "sim/describe/models.hpp"

namespace ex9000::sim {

/// An object: the firmware's version, and under `models` one object a model with its facts, DCON commands,
/// Modbus functions and registers. Numbers are numbers, addresses as on the line; what there is not is null.
std::string json_of(const Models& models);

}  // namespace ex9000::sim
