// The host watchdog - wire.md section 6. When it expires, the module drives its outputs to the safe value.
#pragma once

#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Keeps only the time of the last restart. The enable flag and the timeout are settings.
class HostWatchdog {
 public:
  /// Restarts the watchdog at `now`. Call this when the settings have been loaded after a reset, when a
  /// request enables the watchdog (even if it was already enabled) or writes the timeout of the enabled
  /// watchdog, for a host OK, and for a request that counts like a host OK (register 0x0251).
  constexpr void restart(Time now) { started_ = now; }

  /// Returns whether the watchdog is enabled and its timeout, VV x 0.1 s, has certainly passed since the last
  /// restart.
  [[nodiscard]] constexpr bool expired(const Settings& settings, Time now) const {
    // A deadline is necessary because the restart may be newer than `now`; `now.since()` would then wrap.
    return expiry(settings).reached(now);
  }

  /// Returns the time at which the watchdog expires if it is not restarted. The result is disarmed if the
  /// watchdog is not enabled.
  [[nodiscard]] constexpr Deadline expiry(const Settings& settings) const {
    return settings.watchdog_enabled ? Deadline(started_ + timeout(settings)) : Deadline();
  }

 private:
  static constexpr Duration timeout(const Settings& settings) {
    constexpr std::uint32_t kUnitMilliseconds = 100;
    // The restart may have happened up to 1 us later than the recorded time.
    constexpr Duration kRoundUp(1);
    return milliseconds(settings.watchdog_timeout * kUnitMilliseconds) + kRoundUp;
  }

  Time started_;
};

}  // namespace ex9000
