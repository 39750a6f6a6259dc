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

bool operator==(const Settings& a, const Settings& b) {
  return same_words(words_of(a), words_of(b), kWordsOf<Settings>);
}

void SettingsChange::set(std::size_t at, std::uint8_t value) {
  named_.bytes[at] = 0xFF;
  values_.bytes[at] = value;
}

void SettingsChange::set_word(std::size_t at, std::uint16_t value) {
  set(at, static_cast<std::uint8_t>(value));
  set(at + 1, static_cast<std::uint8_t>(value >> 8U));
}

void SettingsChange::name(const Name& value) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
  for (std::size_t i = 0; i < sizeof value; ++i) {
    set(offsetof(Settings, name) + i, bytes[i]);
  }
}

void SettingsChange::clear() {
  for (std::size_t i = 0; i < kWordsOf<Image>; ++i) {
    words_of(named_)[i] = 0;
  }
}

Settings SettingsChange::applied_to(const Settings& settings) const {
  Settings changed = settings;
  for (std::size_t i = 0; i < kWordsOf<Settings>; ++i) {
    const Word named = words_of(named_)[i];
    Word& word = words_of(changed)[i];
    word = (word & ~named) | (words_of(values_)[i] & named);
  }
  return changed;
}

}  // namespace ex9000
