#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// How long what nobody sets a timer for may have to wait: that INIT* has changed, or that a register of the
/// outputs is to be written anew. What has a time of its own is on time by the wake timer, so a longer period
/// would save little, and a shorter one would wake a module that has nothing to do.
constexpr Duration kTickPeriod = milliseconds(10);

/// A periodic interrupt that calls `Device::on_tick`: the sign of life that the hardware watchdog waits for
/// beside the main loop's.
class Tick {
 public:
  /// From now on, every `kTickPeriod`. Main loop, once after reset; does not block.
  virtual void start() = 0;

 protected:
  ~Tick() = default;
};

}  // namespace ex9000::hal
