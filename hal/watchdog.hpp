// The MCU's own watchdog. It starts at the first `feed` or earlier; the firmware never stops it.
//     void feed()     Restarts the countdown, at most `kWatchdogPeriod`. From the main loop; does not block.
//     void restart()  On a board: resets the MCU at once, and does not return. From the main loop.
//     void start()    On a board: starts the countdown. Once after reset, before the other drivers start.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// Without a feed, the MCU is reset within this time (wire.md section 6), or later while its clocks start.
inline constexpr Duration kWatchdogPeriod = milliseconds(1600);

}  // namespace ex9000::hal
