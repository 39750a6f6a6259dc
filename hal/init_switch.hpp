#pragma once

#include <type_traits>
#include <utility>

#include "hal/promise.hpp"

namespace ex9000::hal {

/// The INIT* pin, active low. If a jumper connects the pin to another signal, INIT* reads as released.
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
