// What an EEPROM holds, as StoredCopy reads it, in the core's types, so that the two can be compared.
#pragma once

#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/oracles/stored_copy.hpp"

namespace ex9000 {

inline StoringModel storing_model(const Model& model) {
  return {model.designation, model.outputs, model.speaks_modbus(), model.longest_name};
}

inline Settings settings_of(const StoredSettings& stored) {
  Settings settings;
  settings.address = stored.address;
  settings.baud_code = stored.baud_code;
  settings.format = stored.format;
  settings.protocol = stored.modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = stored.watchdog_timeout;
  settings.watchdog_enabled = stored.watchdog_enabled;
  settings.timeout_status = stored.timeout_status;
  settings.name = Name(stored.name);
  settings.power_on_value = stored.power_on_value;
  settings.safe_value = stored.safe_value;
  return settings;
}

/// wire.md 2: what a module comes up with whose EEPROM holds that, both copies from `memory` on.
inline Settings settings_from(const Model& model, const std::uint8_t* memory) {
  const StoringModel storing = storing_model(model);
  const std::uint8_t* const copy = later_good_copy(storing, memory);
  return copy == nullptr ? Settings::factory(model) : settings_of(StoredCopy(storing, copy).settings());
}

}  // namespace ex9000
