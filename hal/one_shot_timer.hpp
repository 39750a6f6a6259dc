#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// The longest time that the wake timer is set to.
inline constexpr Duration kLongestWake = milliseconds(1000);

/// A timer that calls one function of `Device` in its interrupt. `Device` requires two:
///
///   - The silence timer calls `on_silence`. It is set to 60 us to 34 ms. Its interrupt and the receive
///     interrupt must not interrupt each other. If both are pending, the interrupt of the silence timer
///     must run first: a byte after the silence does not belong to the frame before the silence.
///   - The wake timer calls `on_wake_timer` for the next event that is due. It is set to 1 us to
///     `kLongestWake`. If this timer failed, the next tick would process the event.
///
///     void restart(Duration after)
///         Makes the timer fire once, `after` from now, at most 5 us late and never early. Cancels an earlier
///         start, even if its interrupt is already pending. For interrupts and the main loop; does not block.
///
/// True if `T` has this function.
template <class T, class = void>
inline constexpr bool kIsOneShotTimer = false;
template <class T>
inline constexpr bool kIsOneShotTimer<
    T, std::void_t<Returns<void, decltype(std::declval<T&>().restart(Exactly<Duration>()))>>> = true;

}  // namespace ex9000::hal
