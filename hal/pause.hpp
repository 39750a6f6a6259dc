// A pause during the start of a board.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// Blocks until at least `duration` has passed on `clock` (hal/clock.hpp), which must run. Only for the start
/// of a board, before the main loop.
template <class Clock>
void pause(const Clock& clock, Duration duration) {
  const Time begin = clock.now();
  while (!(duration < clock.now().since(begin))) {
  }
}

}  // namespace ex9000::hal
