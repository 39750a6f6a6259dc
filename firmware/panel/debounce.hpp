// Debounces a switch.
#pragma once

#include "firmware/time.hpp"

namespace ex9000 {

/// Accepts a level when every sample for at least 10 ms has had it (wire.md D13).
class Debounce {
 public:
  /// In every pass of the main loop.
  void sample(bool level, Time now) {
    if (!sampled_ || level != candidate_) {
      sampled_ = true;
      candidate_ = level;
      settles_.set(now + kSettle);
    }
    if (!settles_.armed()) {
      return;
    }
    next_sample_ = settles_;
    next_sample_.advance_to(Deadline(now + kSampleInterval));
    if (settles_.reached(now)) {
      level_ = level;
      known_ = true;
      settles_.disarm();
      next_sample_.disarm();
    }
  }

  /// Whether a level has been accepted since reset; until then, `level` is false.
  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] bool level() const { return level_; }
  /// At most 1 ms after the last sample; disarmed while no level is waiting to be accepted.
  [[nodiscard]] const Deadline& next_sample() const { return next_sample_; }

 private:
  static constexpr Duration kSettle = milliseconds(10);
  static constexpr Duration kSampleInterval = milliseconds(1);

  bool sampled_ = false;
  bool candidate_ = false;
  bool known_ = false;
  bool level_ = false;
  Deadline settles_;
  Deadline next_sample_;
};

}  // namespace ex9000
