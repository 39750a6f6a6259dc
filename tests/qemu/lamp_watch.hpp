// Checks the status LED whenever the machine stops.
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>

namespace ex9000::rig {

/// Verifies later that a lit LED is on steadily and does not flash. To wait for it would take time that the
/// surrounding steps measure. The transcript first assumes that it is on, and this class compares the
/// assumption with later states: flashing begins with its longest phase, so an LED that is dark before that
/// phase has elapsed was flashing all the time.
class LampWatch {
 public:
  /// The phase of the 2 Hz flashing after a timeout. Flashing for other reasons is faster.
  static constexpr std::chrono::milliseconds kPhase{250};

  /// Assumes that the LED is steadily on.
  void believe(std::chrono::nanoseconds now) { until_ = now + kPhase; }
  /// Discards the assumption after a reset or a power cut.
  void forget() { until_.reset(); }
  /// Compares the current state with the assumption. Throws std::runtime_error if the assumption was wrong.
  void look(std::chrono::nanoseconds now, bool lit) {
    if (until_ && now >= *until_) {
      until_.reset();
    } else if (until_ && !lit) {
      until_.reset();
      throw std::runtime_error("the LED was flashing when it was to be on");
    }
  }
  /// Returns when the assumption will be verified, or nothing if there is none.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> until() const { return until_; }

 private:
  std::optional<std::chrono::nanoseconds> until_;
};

}  // namespace ex9000::rig
