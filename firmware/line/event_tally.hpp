// Passes a count of events from an interrupt to the main loop.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"

namespace ex9000 {

/// Each event counts exactly once, if the main loop collects at least once every 65535 events.
class EventTally {
 public:
  [[gnu::always_inline]] void count_in_interrupt(unsigned events = 1) {
    total_.store_in_interrupt(static_cast<std::uint16_t>(total_.load() + events));
  }

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
