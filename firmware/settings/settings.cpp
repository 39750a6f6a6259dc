#include "firmware/settings/settings.hpp"

namespace ex9000 {

bool Name::is_possible(unsigned longest) const {
  if (length_ == 0 || length_ > longest) {
    return false;
  }
  for (const std::uint8_t character : bytes()) {
    if (!is_name_character(character)) {
      return false;
    }
  }
  return true;
}

bool InputFilters::any() const { return !(*this == InputFilters()); }

bool InputFilters::are_possible(unsigned channels) const {
  for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
    if (of(channel) > (channel < channels ? kLongest : 0)) {
      return false;
    }
  }
  return true;
}

Settings Settings::factory(const Model& model) {
  Settings settings;
  settings.address = kFactoryAddress;
  settings.baud_code = kFactoryBaudCode;
  settings.protocol = model.speaks_modbus() ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = kFactoryWatchdogTimeout;
  settings.name = Name(model.factory_name);
  settings.updates_allowed = true;
  return settings;
}

bool Settings::possible_for(const Model& model) const {
  const bool protocol_fits =
      protocol == Protocol::Ascii || (model.speaks_modbus() && is_modbus_address(address));
  const bool watchdog_fits = !watchdog_enabled || watchdog_timeout != 0;
  const bool outputs_fit = ((power_on_value | safe_value) & ~model.output_mask()) == 0;
  const bool inputs_fit =
      (inverted_inputs & ~model.input_mask()) == 0 && input_filters.are_possible(model.inputs);
  const bool serial_number_fits =
      serial_number == 0 || serial_number == serial_number_of(static_cast<std::uint16_t>(serial_number));
  return is_baud_code(baud_code) && (format & ~kFormatMask) == 0 && protocol_fits && watchdog_fits &&
         name.is_possible(model.longest_name) && outputs_fit && inputs_fit &&
         response_delay <= kLongestResponseDelay && serial_number_fits;
}

bool operator==(const Settings& a, const Settings& b) {
  bool same = true;
  visit([&same](const auto& of_a, const auto& of_b) { same = same && of_a == of_b; }, a, b);
  return same;
}

Settings SettingsChange::applied_to(const Settings& settings) const {
  Settings changed = settings;
  visit([](auto& value, const auto& change) { value = change.value_or(value); }, changed, *this);
  return changed;
}

}  // namespace ex9000
