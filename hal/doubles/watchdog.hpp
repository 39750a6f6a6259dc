#pragma once

#include "hal/doubles/virtual_clock.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal::doubles {

/// When `has_expired()`, the owner must reset the module.
class Watchdog {
 public:
  explicit Watchdog(const VirtualClock& clock) : clock_(clock) {}

  void feed() { expiry_time_ = clock_.when(kWatchdogPeriod); }

  [[nodiscard]] VirtualTime next() const { return expiry_time_; }
  [[nodiscard]] bool has_expired() const { return expiry_time_ <= clock_.virtual_now(); }

 private:
  const VirtualClock& clock_;
  VirtualTime expiry_time_ = kNever;
};

}  // namespace ex9000::hal::doubles
