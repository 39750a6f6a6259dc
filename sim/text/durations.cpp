#include "sim/text/durations.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string_view>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using hal::doubles::VirtualTime;

struct Unit {
  std::string_view name;
  std::int64_t nanoseconds;
};

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::array<Unit, 5> kUnits{{{"us", 1'000},
                                      {"ms", 1'000'000},
                                      {"s", kNanosecondsPerSecond},
                                      {"min", 60 * kNanosecondsPerSecond},
                                      {"h", 3600 * kNanosecondsPerSecond}}};
constexpr long double kYear = 365.0L * 24 * 3600e9L;

/// In units of `unit` ns, a power of ten, exactly. `time` must not be negative.
std::string decimal_text(VirtualTime time, std::int64_t unit) {
  std::string fraction = std::to_string(unit + time.count() % unit).substr(1);
  fraction.resize(fraction.find_last_not_of('0') + 1);
  return std::to_string(time.count() / unit) + (fraction.empty() ? "" : "." + fraction);
}

}  // namespace

VirtualTime parse_time(const std::string& text) {
  static_assert(std::numeric_limits<long double>::digits >= 55,
                "long double is not exact up to a year in ns; it requires at least 55 binary digits");
  long double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  for (const Unit& known : kUnits) {
    const long double nanoseconds = value * static_cast<long double>(known.nanoseconds);
    if (error == std::errc() && unit == known.name && nanoseconds >= 0 && nanoseconds <= kYear) {
      return VirtualTime(std::llround(nanoseconds));
    }
  }
  fail("'" + text + "': expected a duration up to a year, for example 300us, 50ms, 12.5s, 2min or 24h");
}

std::string time_text(VirtualTime time) {
  const Unit& unit = time < std::chrono::milliseconds(1) ? kUnits[0]
                     : time < std::chrono::seconds(1)    ? kUnits[1]
                                                         : kUnits[2];
  return decimal_text(time, unit.nanoseconds) + std::string(unit.name);
}

std::string seconds_text(VirtualTime time) { return decimal_text(time, kNanosecondsPerSecond); }

std::string stamp_text(VirtualTime time) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(6) << std::setw(12) << std::chrono::duration<double>(time).count();
  return text.str();
}

std::string note_text(VirtualTime time, const std::string& text) { return stamp_text(time) + "  - " + text; }

}  // namespace ex9000::sim
