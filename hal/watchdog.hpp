#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// If the hardware watchdog is not fed, it resets the MCU after this time at the latest (wire.md section 6).
inline constexpr Duration kWatchdogPeriod = milliseconds(1600);

/// The MCU's own watchdog. It is running after the first `feed` at the latest and cannot be stopped.
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
