// Converts between baud rates and termios constants, and converts line formats to termios flags.
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>

#include "firmware/model/line_format.hpp"

namespace ex9000::sim {

/// Returns the termios constant for a rate in bits per second, or nullopt if there is none.
std::optional<speed_t> termios_speed(std::uint32_t baud);

/// The flags of `c_cflag` that define a line format together with CS8.
constexpr tcflag_t kTermiosFormat = CSTOPB | PARENB | PARODD;
/// Returns the flags of kTermiosFormat that are set in this line format.
tcflag_t termios_format(LineFormat format);

}  // namespace ex9000::sim
