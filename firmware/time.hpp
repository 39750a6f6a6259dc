// Time as the core sees it: microseconds from outside, in 32 bits that wrap every 71.6 minutes.
#pragma once

#include <cstdint>

namespace ex9000 {

/// A length of time in microseconds, 0 to 2^32-1 (71.6 minutes).
class Duration {
 public:
  constexpr Duration() = default;
  constexpr explicit Duration(std::uint32_t microseconds) : microseconds_(microseconds) {}

  [[nodiscard]] constexpr std::uint32_t microseconds() const { return microseconds_; }

  friend constexpr bool operator<(Duration a, Duration b) { return a.microseconds_ < b.microseconds_; }
  friend constexpr bool operator==(Duration a, Duration b) { return a.microseconds_ == b.microseconds_; }
  friend constexpr Duration operator+(Duration a, Duration b) {
    return Duration(a.microseconds_ + b.microseconds_);
  }
  /// `b` is not the longer one.
  friend constexpr Duration operator-(Duration a, Duration b) {
    return Duration(a.microseconds_ - b.microseconds_);
  }

 private:
  std::uint32_t microseconds_ = 0;
};

constexpr Duration milliseconds(std::uint32_t value) { return Duration(value * 1000U); }

/// A point in time. It wraps, so it has no order: ask for the Duration since an earlier point, which is right
/// while less than 71.6 minutes lie between the two.
class Time {
 public:
  constexpr Time() = default;
  constexpr explicit Time(std::uint32_t microseconds) : microseconds_(microseconds) {}

  /// The count as it was given, for handing it over where only a word fits.
  [[nodiscard]] constexpr std::uint32_t microseconds() const { return microseconds_; }
  [[nodiscard]] constexpr Duration since(Time earlier) const {
    return Duration(microseconds_ - earlier.microseconds_);
  }
  friend constexpr Time operator+(Time time, Duration duration) {
    return Time(time.microseconds_ + duration.microseconds());
  }

 private:
  std::uint32_t microseconds_ = 0;
};

/// A point in time that may lie ahead. Right while it is asked about less than 35 minutes from the point;
/// whoever has acted on it disarms it.
class Deadline {
 public:
  constexpr void set(Time when) {
    when_ = when;
    armed_ = true;
  }
  constexpr void disarm() { armed_ = false; }

  [[nodiscard]] constexpr bool armed() const { return armed_; }
  [[nodiscard, gnu::always_inline]] constexpr bool reached(Time now) const {
    return armed_ && now.since(when_).microseconds() < kHalfRange;
  }
  /// How long until it is reached, 0 where it is; only for one that is armed.
  [[nodiscard]] constexpr Duration remaining(Time now) const {
    return reached(now) ? Duration() : when_.since(now);
  }

 private:
  static constexpr std::uint32_t kHalfRange = 0x8000'0000U;

  Time when_;
  bool armed_ = false;
};

}  // namespace ex9000
