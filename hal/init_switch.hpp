#pragma once

#include <type_traits>
#include <utility>

#include "hal/promise.hpp"

namespace ex9000::hal {

/// The INIT* pin, active low. Where a jumper has given the pin to another signal it reads released.
///
///     bool asserted() const
///         INIT* is tied to GND at this moment; bounces and all. Main loop; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsInitSwitch = false;
template <class T>
inline constexpr bool
    kIsInitSwitch<T, std::void_t<Returns<bool, decltype(std::declval<const T&>().asserted())>>> = true;

}  // namespace ex9000::hal
