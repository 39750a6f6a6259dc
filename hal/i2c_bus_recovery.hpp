// Frees an I2C bus that a device blocks. Sources: NXP UM10204, 3.1.16; AT24C64 data sheet, "memory reset".
#pragma once

#include <cstdint>

#include "firmware/time.hpp"

namespace ex9000::hal {

/// A device may hold the data line low after an interrupted transfer, for example by a reset of the MCU. This
/// sends clock pulses until it releases the line, at most nine, then START and STOP. The caller must then
/// connect the lines to the master again. For the main loop; nothing blocks. `Wires` drives the lines
/// directly, as open-drain outputs with pull-ups:
///     void take()                         Disconnects the lines from the master and lets them float.
///     void pull(bool clock, bool data)    Drives a line low if its argument is true; else lets it float.
///     bool data_is_high()
template <class Wires>
class I2cBusRecovery {
 public:
  void begin() {
    Wires::take();
    step_ = kFirstClock;
    deadline_.disarm();
  }

  /// True: the recovery has ended. Else call it again at once.
  bool poll(Time now) {
    if (deadline_.armed() && !deadline_.reached(now)) {
      return false;
    }
    deadline_.set(now + kHalfClock);
    const bool clock_released = step_ % 2 == kFirstClock;
    if (step_ < kBusStart && clock_released && Wires::data_is_high()) {
      step_ = kBusStart;
    }
    if (step_ < kBusStart) {
      Wires::pull(clock_released, false);
    } else if (step_ == kBusStart) {
      Wires::pull(false, true);
    } else if (step_ == kBusStop) {
      Wires::pull(false, false);
    } else {
      return true;
    }
    ++step_;
    return false;
  }

 private:
  static constexpr std::uint8_t kFirstClock = 0;
  static constexpr std::uint8_t kBusStart = 18;  ///< after nine clock pulses of two steps each
  static constexpr std::uint8_t kBusStop = 19;
  static constexpr Duration kHalfClock{5};

  std::uint8_t step_ = kFirstClock;
  Deadline deadline_;
};

}  // namespace ex9000::hal
