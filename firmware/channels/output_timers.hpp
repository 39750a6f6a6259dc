// The timers of the timed outputs - firmware/extensions.md.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// One timer for each output. A timer counts units of 0.1 s, because its time, up to 6553.5 s, may be longer
/// than a Deadline permits (time.hpp). For the main loop only.
class OutputTimers {
 public:
  /// Starts the timer of `channel` with a time of `units` x 0.1 s. `units`: 1 to 65535. A running timer
  /// starts again.
  void start(unsigned channel, std::uint16_t units, Time now);
  /// Stops the timers of `channels`, bit n for channel n.
  void stop(std::uint16_t channels) { running_ = static_cast<std::uint16_t>(running_ & ~channels); }
  /// Stops the timers that have expired and returns their channels, bit n for channel n. While a timer runs,
  /// call this in every pass of the main loop; two calls must be at most 30 minutes apart.
  std::uint16_t expire(Time now);

  /// Returns the channels whose timer is running; bit n is channel n.
  [[nodiscard]] std::uint16_t running() const { return running_; }
  /// Returns how many units of 0.1 s were left at the last `start` or `expire`, including the current unit; 0
  /// if the timer of `channel` does not run.
  [[nodiscard]] std::uint16_t left(unsigned channel) const;
  /// When `expire` must be called; disarmed if no timer runs.
  [[nodiscard]] Deadline next_end() const;

 private:
  struct Timer {
    std::uint16_t units = 0;  ///< units left, including the current one
    Deadline unit_end;        ///< end of the current unit
  };

  [[nodiscard]] bool is_running(unsigned channel) const { return (running_ >> channel & 1U) != 0; }

  std::uint16_t running_ = 0;
  std::array<Timer, kMaxOutputs> timers_{};
};

}  // namespace ex9000
