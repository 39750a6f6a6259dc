// The rate of a terminal.
#pragma once

#include <cstdint>
#include <optional>

namespace ex9000::sim {

/// Returns the output rate of the terminal `fd`, in bits per second: any rate that a program has set, also
/// one without a termios constant, and one that was set with BOTHER. `fd` may be either end of a
/// pseudo-terminal. Returns nullopt if the rate is 0 (B0, hang up) or cannot be read. Does not block.
std::optional<std::uint32_t> terminal_rate(int fd);

}  // namespace ex9000::sim
