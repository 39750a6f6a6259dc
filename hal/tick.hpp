#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// How long what nobody sets a timer for may have to wait: that INIT* has changed, or that a register of the
/// outputs is to be written anew. What has a time of its own is on time by the wake timer, so a longer period
/// would save little, and a shorter one would wake a module that has nothing to do.
constexpr Duration kTickPeriod = milliseconds(10);

/// A periodic interrupt that calls `Device::on_tick`: the sign of life that the hardware watchdog waits for
/// beside the main loop's.
///
///     void start()
///         From now on, every `kTickPeriod`. Main loop, once after reset; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
constexpr bool kIsTick = false;
template <class T>
constexpr bool kIsTick<T, std::void_t<Returns<void, decltype(std::declval<T&>().start())>>> = true;

}  // namespace ex9000::hal
