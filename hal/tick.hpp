// A periodic interrupt that calls `Device::on_tick`. After the start of the module, the hardware watchdog is
// fed only if both the tick and the main loop have run since the last feed.
//
//     void start()
//         Starts the interrupt, with the period `kTickPeriod` or, in the simulator, a longer one. For the
//         main loop, once after reset; does not block.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// The period of a board's tick. It limits the delay of events that have no deadline, for example a change of
/// INIT*, or a disturbance that changes an output register. For events with a deadline, the wake timer wakes
/// the main loop at the deadline. A shorter period would wake an idle module more often.
inline constexpr Duration kTickPeriod = milliseconds(10);

}  // namespace ex9000::hal
