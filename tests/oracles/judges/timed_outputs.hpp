// The earliest times at which outputs with a timer may be switched off: an independent implementation of
// wire.md 12.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

/// Stores for each output the earliest time at which its timer may end. Ignores commands that end a timer or
/// switch an output off.
class TimedOutputs {
 public:
  /// Call this when a request that ended at `last` has been received. The request can restart the running
  /// timer of an output with a shorter time. Such a restart changes no values, so `started` is not called.
  void may_be_restarted(const Demand& demand, Microseconds last) {
    for (unsigned channel = 0; channel < ends_.size(); ++channel) {
      if (starts(demand, channel)) {
        ends_[channel] = std::min(ends_[channel], end_of(demand, channel, last));
      }
    }
  }

  /// Call this when the timers of these channels have started. Then call `may_be_started_by` for each request
  /// that the module may have executed. A timer that none of these requests starts may end at any time.
  void started(std::uint16_t channels) {
    for (unsigned channel = 0; channel < ends_.size(); ++channel) {
      ends_[channel] = (channels >> channel & 1U) != 0 ? kAnyTime : ends_[channel];
    }
  }
  /// Call this after `started`, for a request that may have started the timers. The request ended at `last`.
  /// `channels`: the same as for `started`.
  void may_be_started_by(const Demand& demand, Microseconds last, std::uint16_t channels) {
    for (unsigned channel = 0; channel < ends_.size(); ++channel) {
      if ((channels >> channel & 1U) != 0 && starts(demand, channel)) {
        const Microseconds end = end_of(demand, channel, last);
        ends_[channel] = ends_[channel] == kAnyTime ? end : std::min(ends_[channel], end);
      }
    }
  }

  /// Returns the channels whose timer, if it was running, may have ended by `now`.
  [[nodiscard]] std::uint16_t that_may_end(Microseconds now) const {
    unsigned channels = 0;
    for (unsigned channel = 0; channel < ends_.size(); ++channel) {
      channels |= now >= ends_[channel] ? 1U << channel : 0U;
    }
    return static_cast<std::uint16_t>(channels);
  }

 private:
  static constexpr Microseconds kUnit = 100 * kMillisecond;
  static constexpr Microseconds kAnyTime = 0;

  static bool starts(const Demand& demand, unsigned channel) { return (demand.timers >> channel & 1U) != 0; }
  static Microseconds end_of(const Demand& demand, unsigned channel, Microseconds last) {
    return last + demand.units[channel] * kUnit;
  }

  std::array<Microseconds, 16> ends_{};
};

}  // namespace ex9000::judges
