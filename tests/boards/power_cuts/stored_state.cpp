#include "tests/boards/power_cuts/stored_state.hpp"

#include <algorithm>
#include <string_view>

#include "hal/eeprom/two_places.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::registers {

namespace {

void put(const Model& model, const Settings& settings, std::uint16_t sequence, std::size_t copy,
         Contents& contents) {
  RecordBytes record{};
  write_record(model, settings, sequence, record);
  std::copy_n(record.begin(), record_size({record.data(), record.size()}),
              contents.begin() + hal::kPlaces[copy]);
}

/// Returns settings that differ from the factory settings as far as the model and the command permit. There
/// is one exception: the settings in firmware/extensions.md have their factory values, except the line format
/// and the settings that the command requires.
Settings full_settings(const Model& model, const StoringCommand& command) {
  Settings settings = Settings::factory(model);
  settings.protocol = command.init == Init::SinceReset ? Protocol::Ascii : command.protocol;
  settings.address = 0x37;
  settings.baud_code = 0x8A;
  settings.format = kFormatMask;
  settings.name = Name(std::string_view("Pump 3"));
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = 0xC8;
  settings.timeout_status = true;
  if (model.outputs != 0) {
    settings.power_on_value = 0x5A5A;
    settings.safe_value = 0xA5A4;
  }
  command.prepare(settings);
  return settings;
}

/// Returns a state with the factory settings, except the settings that the command requires.
State factory_state(const Model& model, const StoringCommand& command) {
  State state;
  state.contents.fill(0xFF);
  state.settings = Settings::factory(model);
  if (command.init != Init::SinceReset) {
    state.settings.protocol = command.protocol;
  }
  command.prepare(state.settings);
  if (state.settings != Settings::factory(model)) {
    put(model, state.settings, 1, 0, state.contents);
  }
  return state;
}

}  // namespace

State begin_at(Beginning beginning, const Model& model, const StoringCommand& command) {
  if (beginning == Beginning::Factory) {
    return factory_state(model, command);
  }
  State state;
  state.contents.fill(0xFF);
  state.settings = full_settings(model, command);
  put(model, Settings::factory(model), 0xFFFE, 0, state.contents);
  put(model, state.settings, 0xFFFF, 1, state.contents);
  if (beginning == Beginning::Longer) {
    constexpr std::uint8_t kLength = 96;
    lengthen(model, state.contents.data(), hal::kPlaces[1], kLength);
  }
  return state;
}

Settings settings_in(const Model& model, const Contents& contents) {
  return settings_from(model, contents.data());
}

std::uint16_t outputs_from_reset(const Settings& settings) {
  return settings.timeout_status ? settings.safe_value : settings.power_on_value;
}

}  // namespace ex9000::registers
