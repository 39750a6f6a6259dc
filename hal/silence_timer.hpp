#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// A one-shot timer that calls `Device::on_silence` in its interrupt. This and the receive interrupt do not
/// interrupt each other; where both wait, this one is served first: a byte that comes after the silence must
/// not be taken for one before it.
class SilenceTimer {
 public:
  /// Fires once, `after` from now, 60 us to 34 ms, at most 5 us late and never early; an earlier start is
  /// forgotten, its interrupt too where that is pending. Interrupts; does not block.
  virtual void restart(Duration after) = 0;

 protected:
  ~SilenceTimer() = default;
};

}  // namespace ex9000::hal
