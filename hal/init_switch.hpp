#pragma once

#include <type_traits>
#include <utility>

#include "hal/promise.hpp"

namespace ex9000::hal {

/// INIT*, active low. On some models, a jumper connects one terminal to INIT* or to another signal. If the
/// jumper does not select INIT*, INIT* reads as released.
///
///     bool asserted() const
///         Returns whether INIT* is connected to GND now. The value is not debounced. For the main loop; does
///         not block.
///
/// True if `T` has this function.
template <class T, class = void>
inline constexpr bool kIsInitSwitch = false;
template <class T>
inline constexpr bool
    kIsInitSwitch<T, std::void_t<Returns<bool, decltype(std::declval<const T&>().asserted())>>> = true;

}  // namespace ex9000::hal
