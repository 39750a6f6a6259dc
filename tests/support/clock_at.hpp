#pragma once

#include "firmware/time.hpp"

namespace ex9000 {

/// A clock that stands still.
struct ClockAt {
  Time time;

  [[nodiscard]] Time now_in_interrupt() const { return time; }
};

}  // namespace ex9000
