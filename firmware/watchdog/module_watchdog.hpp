// When the MCU's hardware watchdog may be fed - wire.md section 6.
#pragma once

#include <cstdint>

#include "firmware/line/crossing.hpp"

namespace ex9000 {

/// Fed only when the main loop and the tick interrupt have both shown life since the last feed: a main loop
/// that spins beside a dead tick is as lost as one that hangs.
class ModuleWatchdog {
 public:
  /// Tick interrupt.
  void tick_alive() { ticks_.store_in_interrupt(ticks_.load() + 1U); }

  /// Main loop, at every tick; that it asks is its sign of life. True: feed now.
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
