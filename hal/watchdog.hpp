#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// Longest time the hardware watchdog waits for a feed before it resets the MCU (wire.md section 6).
inline constexpr Duration kWatchdogPeriod = milliseconds(1600);

/// The MCU's own watchdog. It runs from the first `feed` on and cannot be stopped.
///
///     void feed()
///         Gives the module another `kWatchdogPeriod` at most. Main loop; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsWatchdog = false;
template <class T>
inline constexpr bool kIsWatchdog<T, std::void_t<Returns<void, decltype(std::declval<T&>().feed())>>> = true;

}  // namespace ex9000::hal
