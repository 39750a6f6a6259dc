#include "tests/boards/power_cuts/stored_state.hpp"

#include <algorithm>
#include <string_view>

#include "firmware/settings/record.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::registers {

namespace {

void put(const Model& model, const Settings& settings, std::uint16_t sequence, std::size_t page,
         Contents& contents) {
  Record record;
  make_record(model, settings, sequence, record);
  std::copy(record.bytes.begin(), record.bytes.end(),
            contents.begin() + static_cast<std::ptrdiff_t>(page * StoredCopy::kDistance));
}

}  // namespace

State begin_at(Beginning beginning, const Model& model, const StoringCommand& command) {
  State state;
  state.contents.fill(0xFF);
  Settings& settings = state.settings;
  settings = Settings::factory(model);
  if (command.init != Init::SinceReset) {
    settings.protocol = command.protocol;
  }
  if (beginning == Beginning::Factory) {
    command.prepare(settings);
    if (settings != Settings::factory(model)) {
      put(model, settings, 1, 0, state.contents);
    }
    return state;
  }
  if (command.init == Init::SinceReset) {
    settings.protocol = Protocol::Ascii;
  }
  settings.address = 0x37;
  settings.baud_code = 0x0A;
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
  put(model, Settings::factory(model), 0xFFFE, 0, state.contents);
  put(model, settings, 0xFFFF, 1, state.contents);
  return state;
}

Settings settings_in(const Model& model, const Contents& contents) {
  return settings_from(model, contents.data());
}

std::uint16_t outputs_from_reset(const Settings& settings) {
  return settings.timeout_status ? settings.safe_value : settings.power_on_value;
}

}  // namespace ex9000::registers
