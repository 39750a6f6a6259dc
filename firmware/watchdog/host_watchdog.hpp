// The host watchdog - wire.md section 6. When it expires, the module drives its outputs to the safe value.
#pragma once

#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Only the time of the last restart. Enable flag and timeout are settings.
class HostWatchdog {
 public:
  /// When the settings have been loaded; when a request enables the watchdog, even if it was enabled, or
  /// writes its timeout while enabled; for a host OK or a request that counts like one (register 0x0251).
  constexpr void restart(Time now) { started_ = now; }

  /// Enabled, and VV x 0.1 s have certainly passed since the last restart.
  [[nodiscard]] constexpr bool expired(const Settings& settings, Time now) const {
    // As a deadline, because the restart may be newer than `now`, and `now.since()` would wrap.
    return expiry(settings).reached(now);
  }

  /// Disarmed if the watchdog is not enabled.
  [[nodiscard]] constexpr Deadline expiry(const Settings& settings) const {
    return settings.watchdog_enabled ? Deadline(started_ + timeout(settings)) : Deadline();
  }

 private:
  static constexpr Duration timeout(const Settings& settings) {
    constexpr std::uint32_t kUnitMilliseconds = 100;
    // The restart may have happened up to 1 us later than recorded.
    constexpr Duration kRoundUp(1);
    return milliseconds(settings.watchdog_timeout * kUnitMilliseconds) + kRoundUp;
  }

  Time started_;
};

}  // namespace ex9000
