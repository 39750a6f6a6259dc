// The MCU's own watchdog. It starts at the first `feed` or earlier, and the firmware never stops it.
//
//     void feed()
//         Restarts the watchdog's countdown, which takes at most `kWatchdogPeriod`. For the main loop; does
//         not block.
//
// On a board, also:
//
//     void start()
//         Starts the countdown. Once after reset, before the other drivers start.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// If the hardware watchdog is not fed, it resets the MCU within this time (wire.md section 6). While a board
/// starts its clocks, this may take longer.
inline constexpr Duration kWatchdogPeriod = milliseconds(1600);

}  // namespace ex9000::hal
