#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// A free-running clock. Its time wraps; see Time.
///
///     Time now() const
///         Returns the time. It never goes back, except when it wraps. For interrupts and the main loop; does
///         not block.
///     Time now_in_interrupt() const
///         Returns the same time as `now`. The call may take less time than a call of `now`. Only for
///         interrupts that the clock's own interrupt cannot interrupt.
///
/// True if `T` has these functions.
template <class T, class = void>
inline constexpr bool kIsClock = false;
template <class T>
inline constexpr bool
    kIsClock<T, std::void_t<Returns<Time, decltype(std::declval<const T&>().now())>,
                            Returns<Time, decltype(std::declval<const T&>().now_in_interrupt())>>> = true;

}  // namespace ex9000::hal
