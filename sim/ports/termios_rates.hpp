// Conversion between baud rates and termios constants.
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>

namespace ex9000::sim {

/// Returns the termios constant for a rate in bits per second, or nullopt if there is none.
std::optional<speed_t> termios_speed(std::uint32_t baud);
/// Returns the rate in `settings`, in bits per second, or nullopt if it is not a known rate.
std::optional<std::uint32_t> termios_rate(const termios& settings);

}  // namespace ex9000::sim
