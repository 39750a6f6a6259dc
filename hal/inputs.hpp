// The input channels. The edge interrupt calls `Device::on_edge` for each edge; edges of a channel before it
// runs may share one call. It must clear a channel's edge flag before it reads the level.
//     std::uint16_t start()
//         Once after reset, from the main loop; does not block. Reports edges from now on, and returns the
//         levels before the first: bit n is channel n, 1 = logic 1 (+4 to +30 V).
//     void make_inputs()
//         On a board, once, at least `kPullsSettle` before `start`. Weak pulls make an open input logic 0.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// A weak pull of the RP2040 or the TM4C123, up to 80 kΩ, moves an open pin with a wire of 10 nF within this
/// time. If `start` read the pin earlier, the later edge would count as a pulse.
inline constexpr Duration kPullsSettle = milliseconds(1);

}  // namespace ex9000::hal
