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

/// Returns the face as lines of up to 79 columns; the counters of a model with more than eight inputs may
/// require more. `number` is the module's position across all lines, from 1, and `now` is the time of its
/// line's clock.
std::vector<std::string> face_text(std::size_t number, const SimulatedModule& module, VirtualTime now,
                                   const Lamps& lamps);

/// Returns a short text for each shown value that differs between `before` and `now`, or for all shown values
/// if `before` is null.
std::vector<std::string> changes_text(const Model& model, const Face* before, const Face& now);

}  // namespace ex9000::sim
