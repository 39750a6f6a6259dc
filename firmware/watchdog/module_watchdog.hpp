// Decides when to feed the MCU's hardware watchdog - wire.md section 6.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"

namespace ex9000 {

/// No feed unless both main loop and tick have run since the last one: if either stops, the MCU is reset.
class ModuleWatchdog {
 public:
  /// From the tick interrupt.
  void tick_alive() { ticks_.store_in_interrupt(ticks_.load() + 1U); }

  /// Whether to feed now. The main loop calls this at least once a tick, which shows that it runs.
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
