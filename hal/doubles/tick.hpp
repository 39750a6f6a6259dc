#pragma once

#include "hal/doubles/virtual_clock.hpp"
#include "hal/tick.hpp"

namespace ex9000::hal::doubles {

class Tick {
 public:
  explicit Tick(const VirtualClock& clock, Duration period = kTickPeriod)
      : clock_(clock), period_(std::chrono::microseconds(period.microseconds())) {}

  void start() { next_ = clock_.virtual_now() + period_; }

  [[nodiscard]] VirtualTime next() const { return next_; }
  /// If true, the caller must call `Device::on_tick`.
  bool fire() {
    if (next_ > clock_.virtual_now()) {
      return false;
    }
    next_ += period_;
    return true;
  }
  /// As if its timer had failed.
  void stop() { next_ = kNever; }

 private:
  const VirtualClock& clock_;
  VirtualTime period_;
  VirtualTime next_ = kNever;
};

}  // namespace ex9000::hal::doubles
