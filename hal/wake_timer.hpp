#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// A one-shot timer that calls `Device::on_wake_timer` in its interrupt, for what is due before the next
/// tick. If it died, all that would be due at the tick.
class WakeTimer {
 public:
  /// Fires once, `after` from now, 1 us to one tick's period, at most 5 us late and never early; an earlier
  /// start is forgotten. Main loop; does not block.
  virtual void restart(Duration after) = 0;

 protected:
  ~WakeTimer() = default;
};

}  // namespace ex9000::hal
