// A module's flow for Node-RED with node-red-contrib-modbus.
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "sim/describe/network_address.hpp"

namespace ex9000::sim {

/// Returns a flow to import, as a JSON array: a tab that reads all values, switches outputs, and clears
/// latches, counters and the timeout status. The ids depend only on the model and the address. `model` must
/// support Modbus.
std::string node_red_flow(const Model& model, const NetworkAddress& network_address);

}  // namespace ex9000::sim
