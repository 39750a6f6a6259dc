#include "firmware/settings/settings.hpp"

#include "firmware/words.hpp"

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
  if (protocol > Protocol::ModbusRtu) {
    return false;
  }
  const bool protocol_possible =
      protocol == Protocol::Ascii || (model.speaks_modbus() && is_modbus_address(address));
  const bool outputs_possible = ((power_on_value | safe_value) & ~model.output_mask()) == 0;
  const bool watchdog_possible = !watchdog_enabled || watchdog_timeout != 0;
  return protocol_possible && outputs_possible && watchdog_possible && is_baud_code(baud_code) &&
         (format & ~kFormatMask) == 0;
}

bool operator==(const Settings& a, const Settings& b) { return words_of(a) == words_of(b); }

void SettingsChange::clear() {
  if (any_) {
    any_ = false;
    named_ = {};
  }
}

[[gnu::noinline]] void SettingsChange::set(std::size_t at, std::uint8_t value) {
  any_ = true;
  named_[at] = 0xFF;
  values_[at] = value;
}

void SettingsChange::name(const Name& value) {
  const auto bytes = bytes_of(value);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    set(offsetof(Settings, name) + i, bytes[i]);
  }
}

void SettingsChange::set_word(std::size_t at, std::uint16_t value) {
  const auto bytes = bytes_of(value);
  set(at, bytes[0]);
  set(at + 1, bytes[1]);
}

Settings SettingsChange::applied_to(const Settings& settings) const {
  const auto named = words_of(named_);
  const auto values = words_of(values_);
  auto words = words_of(settings);
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = (words[i] & ~named[i]) | (values[i] & named[i]);
  }
  return object_in<Settings>(words);
}

}  // namespace ex9000
