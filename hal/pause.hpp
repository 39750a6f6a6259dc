// A pause during the start of a board.
#pragma once

#include "firmware/time.hpp"
#include "hal/clock.hpp"

namespace ex9000::hal {

/// Blocks until at least `duration` has passed on `clock`, which must run. Only for the start of a board,
/// before the main loop.
template <class Clock>
void pause(const Clock& clock, Duration duration) {
  static_assert(kIsClock<Clock>, "Clock: lacks a function, or a function has a wrong signature");
  const Time begin = clock.now();
  while (!(duration < clock.now().since(begin))) {
  }
}

}  // namespace ex9000::hal
