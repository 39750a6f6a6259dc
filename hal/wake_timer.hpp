#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// The longest time that the wake timer is set to.
inline constexpr Duration kLongestWake = milliseconds(1000);

/// A one-shot timer that calls `Device::on_wake_timer` in its interrupt, for whatever is due next. If it
/// failed, everything would be due at the next tick.
///
///     void restart(Duration after)
///         Fires once, `after` from now, 1 us to `kLongestWake`, at most 5 us late and never early. An
///         earlier start is forgotten. Main loop; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsWakeTimer = false;
template <class T>
inline constexpr bool
    kIsWakeTimer<T, std::void_t<Returns<void, decltype(std::declval<T&>().restart(Exactly<Duration>()))>>> =
        true;

}  // namespace ex9000::hal
