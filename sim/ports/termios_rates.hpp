// Rates as termios has them.
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>

namespace ex9000::sim {

/// The number that termios has for a rate in bits per second, or nothing.
std::optional<speed_t> termios_speed(std::uint32_t baud);
/// The rate that is set there.
std::optional<std::uint32_t> termios_rate(const termios& settings);

}  // namespace ex9000::sim
