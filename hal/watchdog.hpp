#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// Longest time the hardware watchdog waits for a feed before it resets the MCU (wire.md section 6).
constexpr Duration kWatchdogPeriod = milliseconds(1600);

/// The MCU's own watchdog. It runs from the first `feed` on and cannot be stopped.
class Watchdog {
 public:
  /// Gives the module another `kWatchdogPeriod` at most. Main loop; does not block.
  virtual void feed() = 0;

 protected:
  ~Watchdog() = default;
};

}  // namespace ex9000::hal
