#include "sim/text/durations.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string_view>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using hal::doubles::VirtualTime;

struct Unit {
  std::string_view name;
  double nanoseconds;
};

constexpr std::array<Unit, 5> kUnits{{{"us", 1e3}, {"ms", 1e6}, {"s", 1e9}, {"min", 60e9}, {"h", 3600e9}}};
constexpr double kYear = 365.0 * 24 * 3600e9;

}  // namespace

VirtualTime parse_time(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  for (const Unit& known : kUnits) {
    const double nanoseconds = value * known.nanoseconds;
    if (error == std::errc() && unit == known.name && nanoseconds >= 0 && nanoseconds <= kYear) {
      return VirtualTime(std::llround(nanoseconds));
    }
  }
  fail("'" + text + "': expected a duration up to a year, for example 300us, 50ms, 12.5s, 2min or 24h");
}

std::string time_text(VirtualTime time) {
  const auto unit = time < std::chrono::milliseconds(1) ? kUnits[0]
                    : time < std::chrono::seconds(1)    ? kUnits[1]
                                                        : kUnits[2];
  std::ostringstream text;
  text << std::fixed << std::setprecision(9) << static_cast<double>(time.count()) / unit.nanoseconds;
  std::string digits = text.str();
  digits.resize(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') {
    digits.pop_back();
  }
  return digits + std::string(unit.name);
}

std::string seconds_text(VirtualTime time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  std::string fraction = std::to_string(kSecond + time.count() % kSecond).substr(1);
  fraction.resize(fraction.find_last_not_of('0') + 1);
  return std::to_string(time.count() / kSecond) + (fraction.empty() ? "" : "." + fraction);
}

std::string stamp_text(VirtualTime time) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(6) << std::setw(12) << std::chrono::duration<double>(time).count();
  return text.str();
}

std::string note_text(VirtualTime time, const std::string& text) { return stamp_text(time) + "  - " + text; }

}  // namespace ex9000::sim
