// A module's face as text, for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/line_monitor/module_view/face.hpp"
#include "sim/virtual_line/bus/module.hpp"

namespace ex9000::sim {

/// The characters that show an LED.
struct Lamps {
  const char* on;
  const char* off;
};
inline constexpr Lamps kRoundLamps{"●", "○"};
inline constexpr Lamps kPlainLamps{"*", "-"};

/// Returns the face as lines of up to 80 columns. A module number above 999, and the counters of a model with
/// more than eight inputs, may require more columns. `number` is the module's position across all lines, from
/// 1, and `now` is the present time of the module's line, which may be later than the time of the line's
/// clock.
std::vector<std::string> face_text(std::size_t number, const SimulatedModule& module, VirtualTime now,
                                   const Lamps& lamps);

/// Returns a short text for each part that differs between `before` and `now`. If `before` is null, each part
/// counts as different. The parts are the supply, INIT*, the settings in force, the LED, the outputs, the
/// power-on and safe values, the inputs, the counters, the latches, and the host watchdog without its
/// remaining time. A part that does not exist in `now`, for example the outputs of a model without outputs,
/// has no text.
std::vector<std::string> changes_text(const Model& model, const Face* before, const Face& now);

}  // namespace ex9000::sim
