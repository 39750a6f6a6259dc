#pragma once

#include "hal/doubles/virtual_clock.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal::doubles {

/// When `has_expired()`, the owner must reset the module; when `restarts()`, for ResetReason::Software.
class Watchdog {
 public:
  explicit Watchdog(const VirtualClock& clock) : clock_(clock) {}

  void feed() { expiry_time_ = restarts_ ? expiry_time_ : clock_.when(kWatchdogPeriod); }

  void restart() {
    restarts_ = true;
    expiry_time_ = clock_.virtual_now();
  }

  [[nodiscard]] VirtualTime next() const { return expiry_time_; }
  [[nodiscard]] bool has_expired() const { return expiry_time_ <= clock_.virtual_now(); }
  [[nodiscard]] bool restarts() const { return restarts_; }

 private:
  const VirtualClock& clock_;
  VirtualTime expiry_time_ = kNever;
  bool restarts_ = false;
};

}  // namespace ex9000::hal::doubles
