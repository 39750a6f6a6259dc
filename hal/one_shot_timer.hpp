#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// The longest time that the wake timer is set to.
inline constexpr Duration kLongestWake = milliseconds(1000);

/// A timer that calls one function of `Device` in its interrupt. A board has two:
///
///   - The silence timer calls `on_silence`. It is set to 60 us to 34 ms. Its interrupt and the receive
///   interrupt
///     do not interrupt each other. If both wait, the silence timer is served first, because a byte that
///     comes after the silence must not be taken for one before it.
///   - The wake timer calls `on_wake_timer` for whatever is due next. It is set to 1 us to `kLongestWake`. If
///   it
///     failed, everything would be done at the next tick.
///
///     void restart(Duration after)
///         Fires once, `after` from now, at most 5 us late and never early. An earlier start is forgotten,
///         even if its interrupt is pending already. Interrupts and main loop; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsOneShotTimer = false;
template <class T>
inline constexpr bool kIsOneShotTimer<
    T, std::void_t<Returns<void, decltype(std::declval<T&>().restart(Exactly<Duration>()))>>> = true;

}  // namespace ex9000::hal
