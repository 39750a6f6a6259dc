// Detects that a status LED that seems to be on steadily is flashing.
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>

namespace ex9000::rig {

/// Verifies that a lit LED is on steadily and does not flash. The steps of a transcript do not wait for this
/// verification, because the wait would change the times that other steps measure. Instead, the caller
/// assumes that the LED is on steadily, and this class compares the assumption with later states. A flashing
/// LED is never lit for longer than `kPhase`. If the LED is dark less than `kPhase` after the assumption,
/// this class reports that the LED flashes.
class LampWatch {
 public:
  /// How long the LED is lit when it flashes at 2 Hz after a timeout. Flashes for other reasons are shorter.
  static constexpr std::chrono::milliseconds kPhase{250};

  /// Assumes that the LED is steadily on.
  void believe(std::chrono::nanoseconds now) { until_ = now + kPhase; }
  /// Discards the assumption, for example after a reset or a power cut.
  void forget() { until_.reset(); }
  /// Compares the state at the time `now` with the assumption. Throws std::runtime_error if the LED is dark
  /// before `until()`.
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
