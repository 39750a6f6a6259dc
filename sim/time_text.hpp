// Spans of time as people write them: 12.5s, 50ms, 300us, 2min, 24h.
#pragma once

#include <string>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

/// Throws std::invalid_argument, one line, where `text` is no number with a unit, negative, or beyond a year.
hal::doubles::VirtualTime parse_time(const std::string& text);

/// In us, ms or s, as parse_time reads it.
std::string time_text(hal::doubles::VirtualTime time);

/// Whole nanoseconds in seconds, without a unit: 1.25, 0.000104166.
std::string seconds_text(hal::doubles::VirtualTime time);

/// As logs begin their lines: seconds with six decimals, right-aligned in 12 columns.
std::string stamp_text(hal::doubles::VirtualTime time);
/// A line of a log that is no frame.
std::string note_text(hal::doubles::VirtualTime time, const std::string& text);

}  // namespace ex9000::sim
