// The part of a module's state that the page shows.
#pragma once

#include "sim/front_ends/panel/messages.hpp"
#include "sim/virtual_line/wires/module.hpp"

namespace ex9000::sim {

/// Four parts that change independently: `plate`, `records` (latches, counters), `hostWatchdog`, and
/// `stored`, the memory. Changes neither line nor module. `now`: the present, not before the line's clock.
Message face_of(const SimulatedModule& module, VirtualTime now);

/// The terminals. Relays and PhotoMOS relays count from 1 on the label, from 0 on the wire.
Message plate_layout(const Model& model);

}  // namespace ex9000::sim
