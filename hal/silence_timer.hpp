#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// A one-shot timer that calls `Device::on_silence` in its interrupt, of the same priority as the receive
/// interrupt.
class SilenceTimer {
 public:
  /// Fires once, `after` from now, 80 us to 34 ms, at most 5 us late and never early; an earlier start is
  /// forgotten, its interrupt too where that is pending. Interrupts; does not block.
  virtual void restart(Duration after) = 0;

 protected:
  ~SilenceTimer() = default;
};

}  // namespace ex9000::hal
