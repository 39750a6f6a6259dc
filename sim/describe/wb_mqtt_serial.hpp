// A module's template for Wiren Board's wb-mqtt-serial.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Returns a device template for /etc/wb-mqtt-serial.conf.d/templates. `model` must support Modbus.
std::string wb_mqtt_serial_template(const Model& model);

}  // namespace ex9000::sim
