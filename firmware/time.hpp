// Time in the core: 32-bit microseconds, which wrap every 71.6 minutes. The caller supplies the time.
#pragma once

#include <cstdint>

namespace ex9000 {

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
  /// `b` must not be longer than `a`.
  friend constexpr Duration operator-(Duration a, Duration b) {
    return Duration(a.microseconds_ - b.microseconds_);
  }

 private:
  std::uint32_t microseconds_ = 0;
};

constexpr Duration milliseconds(std::uint32_t value) { return Duration(value * 1000U); }

/// Times wrap, so they have no order and no `<`. `since` needs `earlier` not to be the later point, and less
/// than 71.6 minutes between the two.
class Time {
 public:
  constexpr Time() = default;
  constexpr explicit Time(std::uint32_t microseconds) : microseconds_(microseconds) {}

  /// For code that can pass only one 32-bit word.
  [[nodiscard]] constexpr std::uint32_t microseconds() const { return microseconds_; }
  [[nodiscard]] constexpr Duration since(Time earlier) const {
    return Duration(microseconds_ - earlier.microseconds_);
  }
  friend constexpr Time operator+(Time time, Duration duration) {
    return Time(time.microseconds_ + duration.microseconds());
  }
  friend constexpr Time operator-(Time time, Duration duration) {
    return Time(time.microseconds_ - duration.microseconds());
  }

 private:
  std::uint32_t microseconds_ = 0;
};

/// A point in time; never, while disarmed. Correct within 35 minutes before and after it, so whoever has
/// acted on a deadline must disarm it or set it again.
class Deadline {
 public:
  constexpr Deadline() = default;
  constexpr explicit Deadline(Time when) : when_(when), armed_(true) {}

  constexpr void set(Time when) {
    when_ = when;
    armed_ = true;
  }
  constexpr void disarm() { armed_ = false; }
  /// Only while armed.
  constexpr void postpone(Duration by) { when_ = when_ + by; }
  /// Becomes `other` if that is earlier.
  [[gnu::always_inline]] constexpr void advance_to(const Deadline& other) {
    if (other.armed_ && (!armed_ || other.reached(when_))) {
      *this = other;
    }
  }
  /// Becomes `other` if that is later.
  constexpr void delay_to(const Deadline& other) {
    if (other.armed_ && !other.reached(when_)) {
      when_ = other.when_;
    }
  }

  [[nodiscard]] constexpr bool armed() const { return armed_; }
  [[nodiscard, gnu::always_inline]] constexpr bool reached(Time now) const {
    return armed_ && now.since(when_).microseconds() < kHalfRange;
  }
  /// 0 if reached. Only while armed.
  [[nodiscard]] constexpr Duration remaining(Time now) const {
    return reached(now) ? Duration() : when_.since(now);
  }

 private:
  static constexpr std::uint32_t kHalfRange = 0x8000'0000U;

  Time when_;
  bool armed_ = false;
};

}  // namespace ex9000
