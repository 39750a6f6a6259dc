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

Settings Settings::factory([[maybe_unused]] const Model& model) {
  Settings settings;
#define EX9000_TAKE_FACTORY_VALUE(type, name, factory_value, possible) settings.name = factory_value;
  EX9000_SETTINGS(EX9000_TAKE_FACTORY_VALUE)
#undef EX9000_TAKE_FACTORY_VALUE
  return settings;
}

bool Settings::possible_for(const Model& model) const {
  const bool address_fits = protocol == Protocol::Ascii || is_modbus_address(address);
  const bool watchdog_fits = !watchdog_enabled || watchdog_timeout != 0;
  bool each_is_possible = true;
#define EX9000_JUDGE(type, name, factory_value, possible) \
  {                                                       \
    [[maybe_unused]] const type& value = this->name;      \
    each_is_possible = each_is_possible && (possible);    \
  }
  EX9000_SETTINGS(EX9000_JUDGE)
#undef EX9000_JUDGE
  return each_is_possible && address_fits && watchdog_fits;
}

bool operator==(const Settings& a, const Settings& b) {
#define EX9000_SAME(type, name, factory_value, possible) a.name == b.name&&
  return EX9000_SETTINGS(EX9000_SAME) true;
#undef EX9000_SAME
}

Settings SettingsChange::applied_to(const Settings& settings) const {
  Settings changed = settings;
#define EX9000_APPLY(type, name, factory_value, possible) \
  if (name) {                                             \
    changed.name = *name;                                 \
  }
  EX9000_SETTINGS(EX9000_APPLY)
#undef EX9000_APPLY
  return changed;
}

}  // namespace ex9000
