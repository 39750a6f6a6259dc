// A module for Node-RED with node-red-contrib-modbus.
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "sim/describe/place.hpp"

namespace ex9000::sim {

/// A flow to import, a JSON array: a tab that reads all, switches outputs, and clears what can be cleared.
/// Ids are the same each time, and others for another model or address. `model` must speak Modbus.
std::string node_red_flow(const Model& model, const Place& place);

}  // namespace ex9000::sim
