#pragma once

#include "hal/doubles/virtual_clock.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal::doubles {

/// Whoever owns it resets the module when it has bitten.
class Watchdog final : public hal::Watchdog {
 public:
  explicit Watchdog(const VirtualClock& clock) : clock_(clock) {}

  void feed() override { bites_ = clock_.when(kWatchdogPeriod); }

  [[nodiscard]] VirtualTime next() const { return bites_; }
  [[nodiscard]] bool bites() const { return bites_ <= clock_.virtual_now(); }

 private:
  const VirtualClock& clock_;
  VirtualTime bites_ = kNever;
};

}  // namespace ex9000::hal::doubles
