// The rate of a terminal.
#pragma once

#include <cstdint>
#include <optional>

namespace ex9000::sim {

/// The output rate in bits per second, also one without a termios constant (BOTHER). `fd` may be either end
/// of a pseudo-terminal. nullopt: the rate is 0 (B0, hang up) or cannot be read.
std::optional<std::uint32_t> terminal_rate(int fd);

}  // namespace ex9000::sim
