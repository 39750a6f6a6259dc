#include "firmware/settings/settings.hpp"

namespace ex9000 {

bool Settings::possible_for(const Model& model) const {
  const Bytes characters = name.bytes();
  if (characters.size == 0 || characters.size > model.longest_name) {
    return false;
  }
  for (const std::uint8_t character : characters) {
    if (!Name::is_name_character(character)) {
      return false;
    }
  }
  const bool protocol_possible =
      protocol == Protocol::Ascii || (model.speaks_modbus() && is_modbus_address(address));
  const bool outputs_possible = ((power_on_value | safe_value) & ~model.output_mask()) == 0;
  const bool watchdog_possible = !watchdog_enabled || watchdog_timeout != 0;
  return protocol_possible && outputs_possible && watchdog_possible && is_baud_code(baud_code) &&
         (format & ~kFormatMask) == 0;
}

bool operator==(const Settings& a, const Settings& b) {
  return a.address == b.address && a.baud_code == b.baud_code && a.format == b.format &&
         a.protocol == b.protocol && a.name == b.name && a.power_on_value == b.power_on_value &&
         a.safe_value == b.safe_value && a.watchdog_enabled == b.watchdog_enabled &&
         a.watchdog_timeout == b.watchdog_timeout && a.timeout_status == b.timeout_status;
}

Settings SettingsChange::applied_to(const Settings& settings) const {
  Settings changed = settings;
  const auto take = [this](Field field, auto& slot, const auto& value) {
    if ((fields_ & field) != 0) {
      slot = value;
    }
  };
  take(kAddress, changed.address, values_.address);
  take(kBaudCode, changed.baud_code, values_.baud_code);
  take(kFormat, changed.format, values_.format);
  take(kProtocol, changed.protocol, values_.protocol);
  take(kName, changed.name, values_.name);
  take(kPowerOnValue, changed.power_on_value, values_.power_on_value);
  take(kSafeValue, changed.safe_value, values_.safe_value);
  take(kWatchdogEnabled, changed.watchdog_enabled, values_.watchdog_enabled);
  take(kWatchdogTimeout, changed.watchdog_timeout, values_.watchdog_timeout);
  take(kTimeoutStatus, changed.timeout_status, values_.timeout_status);
  return changed;
}

}  // namespace ex9000
