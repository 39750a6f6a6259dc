// The data from which all exports are generated.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

using Models = std::vector<const Model*>;

Models all_models();

/// From the firmware's tables: what `models` have in common, and an object for each under `models`.
/// `ex9000-sim describe --format json` prints it, with all names that templates can use. Addresses are
/// protocol addresses, PLC numbers are texts; missing texts and numbers are null, missing lists are empty.
/// `entities`: the values and buttons that tools show of a module, from `modbus_registers`, with names.
nlohmann::ordered_json description(const Models& models);

}  // namespace ex9000::sim
