// Decides when to feed the MCU's hardware watchdog - wire.md section 6.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"

namespace ex9000 {

/// Allows a feed only if both the main loop and the tick interrupt have run since the last feed. If either
/// one stops, the hardware watchdog resets the MCU.
class ModuleWatchdog {
 public:
  /// Records that the tick interrupt runs. The tick interrupt calls this.
  void tick_alive() { ticks_.store_in_interrupt(ticks_.load() + 1U); }

  /// Returns whether the hardware watchdog must be fed now. The main loop calls this at least once a tick;
  /// the call itself shows that the main loop runs.
  bool main_loop_alive() {
    const std::uint32_t ticks = ticks_.load();
    const bool both = ticks != ticks_at_feed_;
    ticks_at_feed_ = ticks;
    return both;
  }

 private:
  WrittenByInterrupt<std::uint32_t> ticks_;
  std::uint32_t ticks_at_feed_ = 0;
};

}  // namespace ex9000
