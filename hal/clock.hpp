#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// Free-running time. Wraps; see Time.
///
///     Time now() const
///         Never blocks; interrupts and main loop may call it. Never goes back.
///     Time now_in_interrupt() const
///         The same for interrupts that the clock's own does not interrupt, which may spare them something.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsClock = false;
template <class T>
inline constexpr bool
    kIsClock<T, std::void_t<Returns<Time, decltype(std::declval<const T&>().now())>,
                            Returns<Time, decltype(std::declval<const T&>().now_in_interrupt())>>> = true;

}  // namespace ex9000::hal
