#pragma once

#include <type_traits>
#include <utility>

#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// The period of a board's tick. It limits the delay of events that have no deadline, for example a change of
/// INIT*, or a disturbance that changes an output register. For events with a deadline, the wake timer wakes
/// the main loop at the deadline. A shorter period would wake an idle module more often.
inline constexpr Duration kTickPeriod = milliseconds(10);

/// A periodic interrupt that calls `Device::on_tick`. After the start of the module, the hardware watchdog is
/// fed only if both the tick and the main loop have run since the last feed.
///
///     void start()
///         Starts the interrupt, with the period `kTickPeriod` or, in the simulator, a longer one. For the
///         main loop, once after reset; does not block.
///
/// True if `T` has this function.
template <class T, class = void>
inline constexpr bool kIsTick = false;
template <class T>
inline constexpr bool kIsTick<T, std::void_t<Returns<void, decltype(std::declval<T&>().start())>>> = true;

}  // namespace ex9000::hal
