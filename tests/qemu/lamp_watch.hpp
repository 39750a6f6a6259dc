// The status LED, looked at whenever there is an occasion.
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>

namespace ex9000::rig {

/// A lamp that is lit may be about to go dark, if it flashes, and to watch it would take time that the steps
/// around measure. So that it is lit and does not flash is believed at first, and held against what is seen
/// later: one that begins to flash begins with its longest phase, so one that is dark before that is over was
/// flashing all the time.
class LampWatch {
 public:
  /// Of what a timeout shows: 2 Hz. Flashing for another reason is faster.
  static constexpr std::chrono::milliseconds kPhase{250};

  /// Somebody says that it is steadily on.
  void believe(std::chrono::nanoseconds now) { until_ = now + kPhase; }
  /// A reset or a power cut: nothing of what was said holds any more.
  void forget() { until_.reset(); }
  /// How it is now. Throws std::runtime_error where what was believed was wrong.
  void look(std::chrono::nanoseconds now, bool lit) {
    if (until_ && now >= *until_) {
      until_.reset();
    } else if (until_ && !lit) {
      until_.reset();
      throw std::runtime_error("the LED was flashing when it was to be on");
    }
  }
  /// When there is nothing left to be proved, if there is.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> until() const { return until_; }

 private:
  std::optional<std::chrono::nanoseconds> until_;
};

}  // namespace ex9000::rig
