// The timers of the timed outputs - firmware/extensions.md.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// One timer per output. It counts units of 0.1 s, because its time, up to 6553.5 s, may be longer than a
/// Deadline permits (time.hpp). In masks, bit n is channel n. For the main loop only.
class OutputTimers {
 public:
  /// `units`: 1 to 65535. Restarts a running timer.
  void start(unsigned channel, std::uint16_t units, Time now);
  void stop(std::uint16_t channels) { running_ = static_cast<std::uint16_t>(running_ & ~channels); }
  /// Stops expired timers; returns their mask. While a timer runs: in every pass, at most 30 minutes apart.
  std::uint16_t expire(Time now);

  [[nodiscard]] std::uint16_t running() const { return running_; }
  /// Units left at the last `start` or `expire`, with the current one; 0 if the timer does not run.
  [[nodiscard]] std::uint16_t left(unsigned channel) const;
  /// When to call `expire`; disarmed if no timer runs.
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
