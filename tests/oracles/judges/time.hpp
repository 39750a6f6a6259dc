// The time base of the judges.
#pragma once

#include <cstdint>
#include <limits>

namespace ex9000::judges {

/// A time on the clock of the test, or a duration.
using Microseconds = std::uint64_t;
constexpr Microseconds kNever = std::numeric_limits<Microseconds>::max();
constexpr Microseconds kMillisecond = 1000;

}  // namespace ex9000::judges
