// The edge flags of input pins, and the levels that belong to them.
#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The result of `settle`; a number, because a function returns a struct of this size in memory.
using Settled = std::uint64_t;
/// The pins whose flags `settle` has cleared.
constexpr std::uint32_t flagged_in(Settled settled) { return static_cast<std::uint32_t>(settled); }
constexpr std::uint32_t levels_in(Settled settled) { return static_cast<std::uint32_t>(settled >> 32U); }

/// Clears the edge flags of `flagged`, then reads the levels of `pins`; again while any of `pins` has a new
/// edge. Such an edge would count twice: now by its level, later by its flag. Flags outside both stay set.
/// `Port` is a register of pins, bit n is pin n:
///     std::uint32_t edges() const                      The watched pins whose edge flag is set.
///     void clear_edges(std::uint32_t pins) const
///     std::uint32_t read(std::uint32_t pins) const     Their levels.
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
