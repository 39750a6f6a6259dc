// A module's face as text, for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/face/face.hpp"
#include "sim/module.hpp"

namespace ex9000::sim {

/// What an LED looks like.
struct Lamps {
  const char* on;
  const char* off;
};
inline constexpr Lamps kRoundLamps{"●", "○"};
inline constexpr Lamps kPlainLamps{"*", "-"};

/// Its plate, lines of up to 79 columns; `number` is its position through all lines, from 1, and `now` what
/// its line's clock shows.
std::vector<std::string> face_text(std::size_t number, const SimulatedModule& module, VirtualTime now,
                                   const Lamps& lamps);

/// What has come between two looks, a few words each; all there is where there was none before.
std::vector<std::string> changes_text(const Model& model, const Face* before, const Face& now);

}  // namespace ex9000::sim
