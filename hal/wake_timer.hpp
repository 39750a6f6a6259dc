#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// A one-shot timer that calls `Device::on_wake_timer` in its interrupt, for what is due before the next
/// tick. If it died, all that would be due at the tick.
///
///     void restart(Duration after)
///         Fires once, `after` from now, 1 us to one tick's period, at most 5 us late and never early; an
///         earlier start is forgotten. Main loop; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
constexpr bool kIsWakeTimer = false;
template <class T>
constexpr bool
    kIsWakeTimer<T, std::void_t<Returns<void, decltype(std::declval<T&>().restart(Exactly<Duration>()))>>> =
        true;

}  // namespace ex9000::hal
