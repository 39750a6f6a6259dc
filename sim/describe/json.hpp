// The commands and registers as JSON, for programs.
#pragma once

#include <string>

#include "sim/describe/models.hpp"

namespace ex9000::sim {

/// Returns an object with the firmware's version and, under `models`, one object for each model with its
/// properties, DCON commands, Modbus functions and registers. Numbers are JSON numbers, except PLC numbers,
/// which are strings. Addresses are protocol addresses. Missing texts and numbers are null; missing lists are
/// empty.
std::string json_of(const Models& models);

}  // namespace ex9000::sim
