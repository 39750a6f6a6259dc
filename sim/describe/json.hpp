// The commands and registers as JSON, for programs.
#pragma once

#include <string>

#include "sim/describe/models.hpp"

namespace ex9000::sim {

/// Returns an object with the firmware's version and, under `models`, one object for each model with its
/// properties, DCON commands, Modbus functions and registers. Numbers are JSON numbers, addresses are
/// protocol addresses, and missing items are null.
std::string json_of(const Models& models);

}  // namespace ex9000::sim
