#pragma once

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::hal::doubles {

class OneShotTimer {
 public:
  explicit OneShotTimer(const VirtualClock& clock) : clock_(clock) {}

  void restart(Duration after) { restart_at(clock_.when(after)); }
  /// kNever: the timer stops.
  void restart_at(VirtualTime fires) { fires_ = fires; }

  [[nodiscard]] VirtualTime next() const { return fires_; }
  /// If true, the caller must call `Device::on_silence` or `on_wake_timer`.
  bool fire() {
    if (fires_ > clock_.virtual_now()) {
      return false;
    }
    fires_ = kNever;
    return true;
  }

 private:
  const VirtualClock& clock_;
  VirtualTime fires_ = kNever;
};

}  // namespace ex9000::hal::doubles
