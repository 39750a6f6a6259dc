// Checks the status LED whenever the machine stops.
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>

namespace ex9000::rig {

/// Verifies later that a lit LED is on steadily and does not flash. Waiting for the next flash would take
/// time that the surrounding steps measure. The transcript assumes that the LED is on, and this class
/// compares the assumption with later states. A flashing LED is never lit for longer than `kPhase`, so an LED
/// that goes dark earlier was flashing.
class LampWatch {
 public:
  /// How long the LED is lit when it flashes at 2 Hz after a timeout. Flashes for other reasons are shorter.
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
      throw std::runtime_error("the LED flashes; expected it to be on steadily");
    }
  }
  /// Returns the time at which the verification of the assumption ends; no value if there is no assumption.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> until() const { return until_; }

 private:
  std::optional<std::chrono::nanoseconds> until_;
};

}  // namespace ex9000::rig
