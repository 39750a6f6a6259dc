#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// If the hardware watchdog is not fed, it resets the MCU within this time (wire.md section 6). While a board
/// starts its clocks, this may take longer.
inline constexpr Duration kWatchdogPeriod = milliseconds(1600);

/// The MCU's own watchdog. It starts at the first `feed` or earlier, and the firmware never stops it.
///
///     void feed()
///         Restarts the watchdog's countdown, which takes at most `kWatchdogPeriod`. For the main loop; does
///         not block.
///
/// True if `T` has this function.
template <class T, class = void>
inline constexpr bool kIsWatchdog = false;
template <class T>
inline constexpr bool kIsWatchdog<T, std::void_t<Returns<void, decltype(std::declval<T&>().feed())>>> = true;

}  // namespace ex9000::hal
