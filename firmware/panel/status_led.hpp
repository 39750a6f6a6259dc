// The patterns of the status LED.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/time.hpp"

namespace ex9000 {

class StatusLed {
 public:
  enum class Pattern : std::uint8_t {
    Steady,              ///< on
    HostTimeout,         ///< flashes at 2 Hz until the timeout status is cleared (manuals 1.8, 2.19)
    SettingsUnreadable,  ///< two short flashes every 2 s (wire.md D8)
  };

  /// In every pass of the main loop.
  void show(Pattern pattern, Time now) {
    if (pattern != pattern_) {
      pattern_ = pattern;
      phase_ = 0;
      arm(now);
    } else if (next_.reached(now)) {
      phase_ = (phase_ + 1U) % kPhases;
      arm(now);
    }
  }

  [[nodiscard]] Pattern pattern() const { return pattern_; }
  [[nodiscard]] bool lit() const { return phase_ % 2 == 0; }
  /// Disarmed while it is steady.
  [[nodiscard]] const Deadline& next_change() const { return next_; }

 private:
  static constexpr unsigned kPhases = 4;

  /// Of the present phase. Only for a pattern that flashes.
  [[nodiscard]] Duration length() const {
    if (pattern_ == Pattern::HostTimeout) {
      return milliseconds(250);
    }
    return phase_ == kPhases - 1 ? milliseconds(1700) : milliseconds(100);
  }

  void arm(Time now) {
    if (pattern_ == Pattern::Steady) {
      next_.disarm();
    } else {
      next_.set(now + length());
    }
  }

  Pattern pattern_ = Pattern::Steady;
  unsigned phase_ = 0;
  Deadline next_;
};

}  // namespace ex9000
