// The clock of the doubles and of the virtual bus. The simulator or a test sets it.
#pragma once

#include <chrono>
#include <cstdint>

#include "firmware/time.hpp"

namespace ex9000::hal::doubles {

/// Since the start of the simulation, or a duration. 64 bits suffice for 292 years.
using VirtualTime = std::chrono::nanoseconds;

constexpr VirtualTime kNever = VirtualTime::max();

class VirtualClock {
 public:
  [[nodiscard]] Time now() const { return Time(static_cast<std::uint32_t>(microseconds_.count())); }
  [[nodiscard]] Time now_in_interrupt() const { return now(); }
  [[nodiscard]] VirtualTime virtual_now() const { return now_; }
  void set(VirtualTime now) {
    now_ = now;
    microseconds_ = std::chrono::duration_cast<std::chrono::microseconds>(now);
  }

  /// The first virtual time at which `now()` is its current value plus `after`.
  [[nodiscard]] VirtualTime when(Duration after) const {
    return microseconds_ + std::chrono::microseconds(after.microseconds());
  }

 private:
  VirtualTime now_{0};
  std::chrono::microseconds microseconds_{0};  ///< `now_` rounded down; stored for speed
};

}  // namespace ex9000::hal::doubles
