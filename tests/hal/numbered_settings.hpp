// Settings for tests of the memories.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

inline const Model& model(std::string_view designation) { return *find_model(designation); }

inline const Model& the_model() { return model("EX9042D-M"); }

inline Settings factory() { return Settings::factory(the_model()); }

/// Returns settings that differ for each `number` below 2,000,000.
inline Settings numbered(unsigned number) {
  Settings settings = factory();
  settings.address = static_cast<std::uint8_t>(1 + number % 247);
  settings.safe_value = static_cast<std::uint16_t>(number & 0x1FFFU);
  settings.watchdog_timeout = static_cast<std::uint8_t>(number * 7 + 1);
  return settings;
}

}  // namespace ex9000
