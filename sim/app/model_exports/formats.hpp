// The formats of `ex9000-sim describe`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/files_and_ports/ports/tcp_address.hpp"

namespace ex9000::sim {

/// The models that a description covers: one or more.
using Models = std::vector<const Model*>;

inline Models all_models() {
  Models models;
  for (const Model& model : kModels) {
    models.push_back(&model);
  }
  return models;
}

// The commands and registers, generated from the firmware's tables.

/// Returns Markdown, for people. For all models, it is the generated section of firmware/registers.md.
std::string markdown_of(const Models& models);

/// Returns JSON, for programs: an object with the firmware's version and, under `models`, one object for each
/// model with its properties, DCON commands, Modbus functions and Modbus map. Counts, codes and addresses are
/// JSON numbers; PLC numbers are strings. Addresses are protocol addresses. Missing texts and numbers are
/// null; missing lists are empty.
std::string json_of(const Models& models);

/// Returns CSV, for spreadsheets and tag lists: a header row and, for each model, one row for each DCON
/// command, coil, discrete input and register. The format is RFC 4180; lines end with CR LF.
std::string csv_of(const Models& models);

// Configurations for other tools. `model` must support Modbus.

/// The addresses that a tool requires to reach a module.
struct NetworkAddress {
  TcpAddress tcp{"127.0.0.1", 5020};  ///< of the simulator
  std::uint8_t address = 0x01;        ///< Modbus address of the module, 1 to 247
  bool modbus_tcp = false;            ///< the port uses Modbus TCP; false: the port passes RTU frames
};

/// Returns YAML for Home Assistant's modbus integration: a hub with the model's switches (if it has outputs),
/// binary sensors and sensors, and comments with actions. The user saves this text as FILE and adds the line
/// `modbus: !include FILE` to configuration.yaml.
std::string home_assistant_hub(const Model& model, const NetworkAddress& network_address);

/// Returns a flow to import into Node-RED with node-red-contrib-modbus, as a JSON array. The tab of the flow
/// reads the values that `shown_by` returns, and clears the timeout status. If the model has outputs, the tab
/// switches them. If the model has inputs, the tab clears their latches and counters. The ids of the nodes
/// are the same in all flows for the same model and Modbus address.
std::string node_red_flow(const Model& model, const NetworkAddress& network_address);

/// Returns a device template of Wiren Board's wb-mqtt-serial, for /etc/wb-mqtt-serial.conf.d/templates.
std::string wb_mqtt_serial_template(const Model& model);

}  // namespace ex9000::sim
