#pragma once

#include "hal/doubles/virtual_clock.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal::doubles {

/// The owner resets the module when `bites()` returns true.
class Watchdog {
 public:
  explicit Watchdog(const VirtualClock& clock) : clock_(clock) {}

  void feed() { bites_ = clock_.when(kWatchdogPeriod); }

  [[nodiscard]] VirtualTime next() const { return bites_; }
  [[nodiscard]] bool bites() const { return bites_ <= clock_.virtual_now(); }

 private:
  const VirtualClock& clock_;
  VirtualTime bites_ = kNever;
};
static_assert(kIsWatchdog<Watchdog>);

}  // namespace ex9000::hal::doubles
