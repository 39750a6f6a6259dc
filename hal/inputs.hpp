// The input channels. The edge interrupt calls `Device::on_edge` for each edge. Edges of a channel that occur
// before the interrupt runs may share one call. The interrupt must clear the edge flag of a channel before it
// reads the level of this channel.
//
//     std::uint16_t start()
//         Starts to report edges, and returns the levels before the first reported edge: bit n is channel n,
//         1 = logic 1 (+4 to +30 V). For the main loop, once after reset; does not block.
//
// On a board, also:
//
//     void make_inputs()
//         Makes the pins inputs. Their weak pulls give an open input the level of logic 0. Once, at least
//         `kPullsSettle` before `start`.
#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// The shortest time between the configuration of the input pins and `start`. A weak pull-up or pull-down of
/// the RP2040 or the TM4C123 has up to 80 kΩ. Within this time, it changes the level of an open pin whose
/// wire has a capacitance of 10 nF. If `start` read the pin earlier, the later edge would count as a pulse.
inline constexpr Duration kPullsSettle = milliseconds(1);

}  // namespace ex9000::hal
