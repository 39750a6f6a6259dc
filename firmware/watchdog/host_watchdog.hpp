// The host watchdog: outputs go to the safe value when the host falls silent - wire.md section 6.
#pragma once

#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Only the time is kept here; whether it runs and how long are settings.
class HostWatchdog {
 public:
  /// From reset, on enabling, and at every host OK.
  constexpr void restart(Time now) { started_ = now; }

  /// VV x 0.1 s after the last restart, and never before.
  [[nodiscard]] constexpr bool expired(const Settings& settings, Time now) const {
    // Not "how long since": an interrupt may have restarted it after the main loop took its `now`.
    return expiry(settings).reached(now);
  }

  /// When it expires if nobody restarts it; disarmed where it does not run.
  [[nodiscard]] constexpr Deadline expiry(const Settings& settings) const {
    Deadline deadline;
    if (settings.watchdog_enabled) {
      deadline.set(started_ + timeout(settings));
    }
    return deadline;
  }

 private:
  static constexpr Duration timeout(const Settings& settings) {
    constexpr std::uint32_t kUnitMilliseconds = 100;
    constexpr Duration kRoundUp(
        1);  // the restart happened up to a microsecond after the time it is noted with
    return milliseconds(settings.watchdog_timeout * kUnitMilliseconds) + kRoundUp;
  }

  Time started_;
};

}  // namespace ex9000
