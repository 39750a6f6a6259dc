// A switch that bounces.
#pragma once

#include "firmware/time.hpp"

namespace ex9000 {

/// A level counts once it has stood for 10 ms (wire.md D13).
class Debounce {
 public:
  /// Main loop, once a turn, with the switch as it is.
  void sample(bool level, Time now) {
    if (!sampled_ || level != candidate_) {
      sampled_ = true;
      candidate_ = level;
      settles_.set(now + kSettle);
    } else if (settles_.reached(now)) {
      level_ = level;
      known_ = true;
      settles_.disarm();
    }
  }

  /// Whether any level has stood long enough since reset.
  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] bool level() const { return level_; }
  /// When the present level counts; disarmed where it does.
  [[nodiscard]] Deadline settles() const { return settles_; }

 private:
  static constexpr Duration kSettle = milliseconds(10);

  bool sampled_ = false;
  bool candidate_ = false;
  bool known_ = false;
  bool level_ = false;
  Deadline settles_;
};

}  // namespace ex9000
