#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// A board's tick. So long may wait what has no time of its own: that INIT* has changed, or that a register
/// of the outputs has to be written again. The wake timer serves everything else on time. A longer period
/// would save little, and a shorter one would wake a module that has nothing to do.
inline constexpr Duration kTickPeriod = milliseconds(10);

/// A periodic interrupt that calls `Device::on_tick`: the sign of life that the hardware watchdog waits for
/// beside the main loop's.
///
///     void start()
///         From now on, every `kTickPeriod`, or in the simulator more rarely. Main loop, once after reset;
///         does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsTick = false;
template <class T>
inline constexpr bool kIsTick<T, std::void_t<Returns<void, decltype(std::declval<T&>().start())>>> = true;

}  // namespace ex9000::hal
