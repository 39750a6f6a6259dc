#pragma once

#include <type_traits>
#include <utility>

#include "hal/promise.hpp"

namespace ex9000::hal {

/// The status LED.
///
///     void light(bool on)
///         Turns the LED on or off. The main loop calls this at least at every tick. This does not block.
///
/// True if `T` has this function.
template <class T, class = void>
inline constexpr bool kIsStatusLed = false;
template <class T>
inline constexpr bool
    kIsStatusLed<T, std::void_t<Returns<void, decltype(std::declval<T&>().light(Exactly<bool>()))>>> = true;

}  // namespace ex9000::hal
