// Converts the settings of a StoredCopy to the type Settings of the core, so that a test can compare them
// with settings of the core. Also writes copies of settings in the form that newer firmware writes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/oracles/stored_copy.hpp"

namespace ex9000 {

inline StoringModel storing_model(const Model& model) {
  return {model.designation,  model.outputs,      model.speaks_modbus(),
          model.longest_name, model.factory_name, model.inputs};
}

inline Settings settings_of(const CopiedSettings& stored) {
  Settings settings;
  settings.address = stored.address;
  settings.baud_code = stored.baud_code;
  settings.format = stored.format;
  settings.protocol = stored.modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = stored.watchdog_timeout;
  settings.watchdog_enabled = stored.watchdog_enabled;
  settings.timeout_status = stored.timeout_status;
  settings.name = Name(std::string_view(stored.name));
  settings.power_on_value = stored.power_on_value;
  settings.safe_value = stored.safe_value;
  for (unsigned channel = 0; channel < stored.filters.size(); ++channel) {
    settings.input_filters.set(channel, stored.filters[channel]);
  }
  settings.inverted_inputs = stored.inverted;
  settings.fed_by_requests = stored.fed_by_requests;
  settings.response_delay = stored.response_delay;
  return settings;
}

/// Returns the settings with which a module starts if `memory`, of kStoredMemory bytes, is the content of its
/// EEPROM (wire.md section 2).
inline Settings settings_from(const Model& model, const std::uint8_t* memory) {
  const StoringModel storing = storing_model(model);
  const std::size_t place = place_that_counts(storing, memory);
  return place == kStoredMemory ? Settings::factory(model)
                                : settings_of(StoredCopy(storing, memory, place).settings());
}

/// Returns an arbitrary value for the byte at position `index` of a record's settings. The byte belongs to a
/// setting that only newer firmware supports.
inline std::uint8_t unknown_byte(std::size_t index) { return static_cast<std::uint8_t>(0xC1U ^ index); }

/// Returns the number of bytes that a record without unknown settings uses for `settings`. The settings in
/// the record end with the last setting that differs from its factory value, but not before the end of
/// `safe_value`. The minimum is therefore 19 bytes.
inline std::size_t bytes_of_settings(const Settings& settings) {
  if (settings.response_delay != 0) {
    return 55;
  }
  if (settings.fed_by_requests) {
    return 54;
  }
  if (settings.inverted_inputs != 0) {
    return 53;
  }
  return settings.input_filters.any() ? 51 : 19;
}

/// The number of bytes of all settings that this firmware supports.
inline constexpr std::size_t kSupportedSettings = 55;

/// Extends the valid record at `place` to `length` bytes of settings. The record must have at
/// least 19 bytes of settings, because the factory value of each later setting is 0. The settings that this
/// firmware supports, but that the record lacks, get their factory values. The bytes after them get the
/// values of `unknown_byte`.
inline void lengthen(const Model& model, std::uint8_t* memory, std::size_t place, std::uint8_t length) {
  std::uint8_t* bytes = memory + place;
  for (std::size_t index = bytes[1]; index < length; ++index) {
    bytes[4 + index] = index < kSupportedSettings ? std::uint8_t{0} : unknown_byte(index);
  }
  bytes[1] = length;
  const StoringModel storing = storing_model(model);
  StoredCopy::seal(storing, memory, place);
}

}  // namespace ex9000
