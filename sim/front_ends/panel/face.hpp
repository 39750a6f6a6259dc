// The part of a module's state that the page shows.
#pragma once

#include "sim/front_ends/panel/messages.hpp"
#include "sim/virtual_line/wires/module.hpp"

namespace ex9000::sim {

/// The state in four parts, which change independently of each other: `plate`, `records` (latches and
/// counters), `hostWatchdog`, and `stored`, the content of the memory. The model is not included, because it
/// does not change. Changes neither the line nor the module. `now` is the present line time. It may be later
/// than the time of the line's clock, but not earlier.
Message face_of(const SimulatedModule& module, VirtualTime now);

/// What the page needs to draw a module of this model: its terminals. Relays and PhotoMOS relays are counted
/// from 1 on the label and from 0 on the wire.
Message plate_layout(const Model& model);

}  // namespace ex9000::sim
