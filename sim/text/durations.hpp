// Durations as people write them (12.5s, 50ms, 300us, 2min, 24h), and times in logs.
#pragma once

#include <string>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

/// A number with a unit, us, ms, s, min or h; up to 365 days.
hal::doubles::VirtualTime parse_time(const std::string& text);

/// In us, ms or s, as parse_time reads it. `time` must not be negative, here and below.
std::string time_text(hal::doubles::VirtualTime time);

/// In seconds, exact to the nanosecond, without a unit: 1.25 or 0.000104166.
std::string seconds_text(hal::doubles::VirtualTime time);

/// The start of a log line: seconds with six decimals, right-aligned in at least 12 columns.
std::string stamp_text(hal::doubles::VirtualTime time);
std::string note_text(hal::doubles::VirtualTime time, const std::string& text);

}  // namespace ex9000::sim
