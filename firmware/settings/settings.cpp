#include "firmware/settings/settings.hpp"

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are types and names
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
  bool same = true;
#define EX9000_COMPARE(type, name, factory_value, possible) same = same && a.name == b.name;
  EX9000_SETTINGS(EX9000_COMPARE)
#undef EX9000_COMPARE
  return same;
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
// NOLINTEND(bugprone-macro-parentheses)
