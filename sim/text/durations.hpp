// Durations as people write them (12.5s, 50ms, 300us, 2min, 24h), and times in logs.
#pragma once

#include <string>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

/// Parses a number with a unit: us, ms, s, min or h. Throws std::invalid_argument with a one-line message if
/// `text` has another form, or if the duration is negative or longer than 365 days.
hal::doubles::VirtualTime parse_time(const std::string& text);

/// Returns the time in us, ms or s, in the format that parse_time reads. `time` must not be negative.
std::string time_text(hal::doubles::VirtualTime time);

/// Returns the time in seconds, exact to the nanosecond, without a unit, for example 1.25 or
/// 0.000104166. `time` must not be negative.
std::string seconds_text(hal::doubles::VirtualTime time);

/// Returns the prefix of log lines: seconds with six decimals, right-aligned in at least 12 columns.
std::string stamp_text(hal::doubles::VirtualTime time);
/// Returns the log line of a note.
std::string note_text(hal::doubles::VirtualTime time, const std::string& text);

}  // namespace ex9000::sim
