// Passes a count of events from an interrupt to the main loop.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"

namespace ex9000 {

/// Counts events in an interrupt and passes the count to the main loop. The main loop must call `collect` at
/// least once every 65535 events. The results of `collect` then include each event exactly once.
class EventTally {
 public:
  /// Counts `events` events. Only for the interrupt.
  [[gnu::always_inline]] void count_in_interrupt(unsigned events = 1) {
    total_.store_in_interrupt(static_cast<std::uint16_t>(total_.load() + events));
  }

  /// Returns the number of events since the last call, modulo 65536. For the main loop.
  std::uint16_t collect() {
    const std::uint16_t total = total_.load();
    const auto fresh = static_cast<std::uint16_t>(total - collected_);
    collected_ = total;
    return fresh;
  }

 private:
  WrittenByInterrupt<std::uint16_t> total_;
  std::uint16_t collected_ = 0;  // for the main loop only
};

}  // namespace ex9000
