// How events cross from an interrupt to the main loop.
#pragma once

#include <cstdint>

#include "firmware/line/crossing.hpp"

namespace ex9000 {

/// Counts events in an interrupt and hands them to the main loop, none lost and none twice, as long as the
/// main loop collects before 65536 have gathered. Neither side ever writes what the other writes.
class EventTally {
 public:
  /// Interrupt.
  [[gnu::always_inline]] void count_in_interrupt(unsigned events = 1) {
    total_.store_in_interrupt(static_cast<std::uint16_t>(total_.load() + events));
  }

  /// Main loop: how many since it was last called, modulo 65536.
  std::uint16_t collect() {
    const std::uint16_t total = total_.load();
    const auto fresh = static_cast<std::uint16_t>(total - collected_);
    collected_ = total;
    return fresh;
  }

 private:
  WrittenByInterrupt<std::uint16_t> total_;
  std::uint16_t collected_ = 0;  // main loop
};

}  // namespace ex9000
