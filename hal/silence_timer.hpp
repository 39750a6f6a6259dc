#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// A one-shot timer that calls `Device::on_silence` in its interrupt. This and the receive interrupt do not
/// interrupt each other; where both wait, this one is served first: a byte that comes after the silence must
/// not be taken for one before it.
///
///     void restart(Duration after)
///         Fires once, `after` from now, 60 us to 34 ms, at most 5 us late and never early; an earlier start
///         is forgotten, its interrupt too where that is pending. Interrupts; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsSilenceTimer = false;
template <class T>
inline constexpr bool kIsSilenceTimer<
    T, std::void_t<Returns<void, decltype(std::declval<T&>().restart(Exactly<Duration>()))>>> = true;

}  // namespace ex9000::hal
