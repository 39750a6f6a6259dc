// The part of a simulated module's state that the page shows.
#pragma once

#include "sim/front_ends/panel/messages.hpp"
#include "sim/front_ends/panel/panel.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Four parts that change independently: `plate`, `records` (latches, counters), `hostWatchdog`, and
/// `stored`, the memory. Changes neither line nor module. `now`: the present, not before the line's clock.
Message face_of(const SimulatedModule& module, VirtualTime now);

/// `line` must live as long; `present` returns its time.
PanelLine panel_line(const LineSummary& summary, const Line& line, std::function<VirtualTime()> present);

/// The terminals. Relays and PhotoMOS relays count from 1 on the label, from 0 on the wire.
Message plate_layout(const Model& model);

}  // namespace ex9000::sim
