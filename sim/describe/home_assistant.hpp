// A module's configuration for Home Assistant's modbus integration.
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "sim/describe/network_address.hpp"

namespace ex9000::sim {

/// Returns YAML for `modbus: !include FILE` in configuration.yaml: a hub with switches, binary sensors and
/// sensors. `model` must support Modbus.
std::string home_assistant_hub(const Model& model, const NetworkAddress& network_address);

}  // namespace ex9000::sim
