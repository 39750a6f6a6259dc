// The earliest time at which the host watchdog of a module may expire: an independent implementation of
// wire.md 6.
#pragma once

#include <algorithm>
#include <cstdint>

#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

/// Stores the times at which the host watchdog last restarted and last expired. If register 0x0251 is 1, each
/// request for the module also restarts the host watchdog. This class does not store these restarts.
class HostWatchdog {
 public:
  void module_reset(Microseconds now) {
    restarted_ = now;
    timed_out_ = 0;
  }
  /// Call this when a command has restarted the host watchdog at `now`.
  void restarted(Microseconds now) { restarted_ = now; }
  /// Call this when a host OK or a command restarts the host watchdog at `when` or later.
  void restarts_at_the_earliest(Microseconds when) { restarted_ = std::max(restarted_, when); }

  /// Returns whether the host watchdog of a module with these values may have expired by `now`.
  [[nodiscard]] bool may_expire(const Values& values, Microseconds now) const {
    constexpr Microseconds kUnit = 100 * kMillisecond;
    return values.enabled && now >= restarted_ + values.timeout * kUnit;
  }

  /// Call this when the host watchdog has expired. `values`: those before the timeout.
  void expired(const Values& values, Microseconds now) {
    outputs_before_ = values.lasting_outputs();
    timed_out_ = now;
  }
  /// Returns whether the latest timeout was at `time` or later.
  [[nodiscard]] bool has_expired_since(Microseconds time) const { return timed_out_ >= time; }
  /// Returns the lasting outputs before the latest timeout.
  [[nodiscard]] std::uint16_t outputs_before() const { return outputs_before_; }

 private:
  Microseconds restarted_ = 0;  ///< the latest restart was not earlier than this
  Microseconds timed_out_ = 0;  ///< time of the latest timeout; 0: none since the last reset
  std::uint16_t outputs_before_ = 0;
};

}  // namespace ex9000::judges
