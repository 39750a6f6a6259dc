// Passes the times of host OKs from interrupts to the main loop.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Stores the times of the first and the last host OK that the main loop has not taken yet. Host OKs between
/// these two do not matter, because the host watchdog cannot expire between the first and the last: a host OK
/// wakes the main loop, and one pass of the main loop is shorter than the shortest timeout, 0.1 s. The time
/// of a request that counts like a host OK (register 0x0251) is stored in the same way.
class HostOks {
 public:
  /// In ASCII, a host OK counts from its CR. In Modbus, it counts from the end of its silence. Exception: if
  /// the module's own reply begins and ends before the end of this silence, the host OK counts from the end
  /// of the reply (wire.md D9, D11).
  struct Times {
    Time first;
    Time last;
  };

  /// Stores the time of a host OK. For interrupts, which must not interrupt each other.
  void add_in_interrupt(Time received) {
    if (!waiting()) {
      first_.store_in_interrupt(received.microseconds());
    }
    last_.store_in_interrupt(received.microseconds());
    received_.store_in_interrupt(received_.load() + 1U);
  }

  /// Returns whether there is a host OK that the main loop has not taken yet.
  [[nodiscard]] bool waiting() const { return received_.load() != taken_.load(); }

  /// Takes all host OKs that are waiting. A host OK that arrives during the call may still be waiting after
  /// the call. The next call may then return the same first time again. For the main loop; call this only if
  /// `waiting()`.
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
