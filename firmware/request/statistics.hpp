// A module's report on its last reset and the time since then - firmware/extensions.md.
#pragma once

#include <cstdint>
#include <limits>

#include "firmware/reset_reason.hpp"
#include "firmware/settings/memory_job.hpp"

namespace ex9000 {

/// Registers 0x0301 to 0x0306. A reset clears the counts.
struct Statistics {
  ResetReason reset_reason = ResetReason::Unknown;
  SettingsSource settings_source = SettingsSource::NoneGood;
  std::uint32_t seconds_up = 0;  ///< since reset
  std::uint16_t timeouts = 0;    ///< of the host watchdog; saturates
  std::uint16_t stores = 0;      ///< verified stores; saturates
};

constexpr void count_saturating(std::uint16_t& count) {
  if (count != std::numeric_limits<std::uint16_t>::max()) {
    ++count;
  }
}

}  // namespace ex9000
