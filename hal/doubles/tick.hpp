#pragma once

#include "hal/doubles/virtual_clock.hpp"
#include "hal/tick.hpp"

namespace ex9000::hal::doubles {

class Tick {
 public:
  explicit Tick(const VirtualClock& clock) : clock_(clock) {}

  void start() { next_ = clock_.virtual_now() + kPeriod; }

  [[nodiscard]] VirtualTime next() const { return next_; }
  /// Whether it fires now; then call the interrupt.
  bool fire() {
    if (next_ > clock_.virtual_now()) {
      return false;
    }
    next_ += kPeriod;
    return true;
  }
  /// The tick stops, as if its timer had died.
  void stop() { next_ = kNever; }

 private:
  static constexpr VirtualTime kPeriod = std::chrono::microseconds(kTickPeriod.microseconds());

  const VirtualClock& clock_;
  VirtualTime next_ = kNever;
};
static_assert(kIsTick<Tick>);

}  // namespace ex9000::hal::doubles
