// Converts between baud rates and termios constants, and converts line formats to termios flags.
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>

#include "firmware/model/line_format.hpp"

namespace ex9000::sim {

/// Returns the termios constant for a rate in bits per second, or nullopt if there is none.
std::optional<speed_t> termios_speed(std::uint32_t baud);
/// Returns the output rate in `settings`, in bits per second, or nullopt if it is not a known rate.
std::optional<std::uint32_t> termios_rate(const termios& settings);

/// The flags of `c_cflag` that define a line format together with CS8.
constexpr tcflag_t kTermiosFormat = CSTOPB | PARENB | PARODD;
/// Returns the flags of kTermiosFormat that are set in this line format.
tcflag_t termios_format(LineFormat format);

}  // namespace ex9000::sim
