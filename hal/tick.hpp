// A periodic interrupt that calls `Device::on_tick`. Once the module has started, the hardware watchdog is
// fed only if tick and main loop have both run since the last feed.
//     void start()    Once after reset, from the main loop; does not block. The period is `kTickPeriod`, or
//                     longer in the simulator.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// Limits the delay of events without a deadline, for example a change of INIT* or a disturbed output
/// register; the wake timer serves deadlines. A shorter period would wake an idle module more often.
inline constexpr Duration kTickPeriod = milliseconds(10);

}  // namespace ex9000::hal
