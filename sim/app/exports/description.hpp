// The data from which all exports are generated.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// One or more models.
using Models = std::vector<const Model*>;

Models all_models();

/// Returns an object with what `models` have in common, and one object for each of them under `models`, from
/// the firmware's tables. `ex9000-sim describe --format json` prints it, so it shows all names that templates
/// can use. Addresses are protocol addresses; PLC numbers are texts. Missing texts and numbers are null,
/// missing lists are empty.
///
/// `entities` are the values and buttons that tools show of a module: a selection from `modbus_registers`,
/// with names.
nlohmann::ordered_json description(const Models& models);

}  // namespace ex9000::sim
