#include "sim/time_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string_view>

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
  throw std::invalid_argument("'" + text + "' is no time; 12.5s, 50ms, 300us, 2min and 24h are");
}

std::string time_text(VirtualTime time) {
  std::ostringstream text;
  text.precision(12);
  text << std::chrono::duration<double>(time).count() << 's';
  return text.str();
}

}  // namespace ex9000::sim
