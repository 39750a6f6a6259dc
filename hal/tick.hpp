#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// A periodic interrupt that calls `Device::on_tick`: the sign of life that the hardware watchdog waits for
/// beside the main loop's.
class Tick {
 public:
  /// From now on, every `period`: 1 ms to a quarter of the watchdog's. Main loop, once after reset; does not
  /// block.
  virtual void start(Duration period) = 0;

 protected:
  ~Tick() = default;
};

}  // namespace ex9000::hal
