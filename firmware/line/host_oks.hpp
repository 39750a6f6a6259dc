// Passes the times of host OKs from interrupts to the main loop.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// The first and the last host OK that the main loop has not taken yet. Those between do not matter: a host
/// OK wakes the main loop, and a pass is shorter than the shortest timeout, 0.1 s, so the host watchdog
/// cannot expire between the two. Requests that count like one (register 0x0251) are stored too.
class HostOks {
 public:
  /// A host OK counts from its CR in ASCII, from the end of its silence in Modbus; but from the end of the
  /// module's own reply if that begins and ends before the end of the silence (wire.md D9, D11).
  struct Times {
    Time first;
    Time last;
  };

  /// These interrupts must not interrupt each other.
  void add_in_interrupt(Time received) {
    if (!waiting()) {
      first_.store_in_interrupt(received.microseconds());
    }
    last_.store_in_interrupt(received.microseconds());
    received_.store_in_interrupt(received_.load() + 1U);
  }

  [[nodiscard]] bool waiting() const { return received_.load() != taken_.load(); }

  /// Only if `waiting()`. A host OK that arrives during the call may still be waiting afterwards; the next
  /// call may then return the same first time again.
  Times take_in_main_loop() {
    const std::uint32_t received = received_.load();
    const Times times{Time(first_.load()), Time(last_.load())};
    taken_.store_in_main_loop(received);
    return times;
  }

 private:
  WrittenByInterrupt<std::uint32_t> received_;
  WrittenByMainLoop<std::uint32_t> taken_;
  WrittenByInterrupt<std::uint32_t> first_;
  WrittenByInterrupt<std::uint32_t> last_;
};

}  // namespace ex9000
