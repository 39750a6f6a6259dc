// The edge flags of input pins, and the levels that belong to them.
#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The result of `settle`. It is a number, because a function returns a struct of this size in memory.
using Settled = std::uint64_t;
/// Returns the pins whose flags `settle` has cleared.
constexpr std::uint32_t flagged_in(Settled settled) { return static_cast<std::uint32_t>(settled); }
constexpr std::uint32_t levels_in(Settled settled) { return static_cast<std::uint32_t>(settled >> 32U); }

/// Clears the edge flags of `flagged` and then reads the levels of `pins`. Repeats both steps while any of
/// `pins` has a new edge, because an edge between the two steps would count twice: now because of its level,
/// and later because of its flag. Flags that are neither in `pins` nor in `flagged` stay set.
///
/// `Port` is a register of pins; bit n is pin n. It has these functions:
///
///     std::uint32_t edges() const                      Returns the watched pins whose edge flag is set.
///     void clear_edges(std::uint32_t pins) const       Clears the edge flags of `pins`.
///     std::uint32_t read(std::uint32_t pins) const     Returns the levels of `pins`.
template <class Port>
[[gnu::noinline]] Settled settle(Port port, std::uint32_t pins, std::uint32_t flagged) {
  std::uint32_t cleared = 0;
  std::uint32_t levels = 0;
  do {
    cleared |= flagged;
    port.clear_edges(flagged);
    levels = port.read(pins);
    flagged = port.edges() & pins;
  } while (flagged != 0);
  return cleared | Settled{levels} << 32U;
}

}  // namespace ex9000::hal
