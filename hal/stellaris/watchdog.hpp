// Watchdog timer 0. Sources: LM3S6965 data sheet, 10.3 to 10.5; TM4C123GH6PM data sheet, 12.3 to 12.5.
#pragma once

#include <cstdint>

#include "hal/cortex_m/interrupts.hpp"
#include "hal/registers/register.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal::stellaris {

/// Counts down twice before it resets the MCU. The first end only sets a flag; its interrupt is not used.
template <std::uint32_t cycles_per_microsecond>
class HardwareWatchdog {
 public:
  /// Runs until the next reset. The registers must be unlocked, as after a reset. Until `SystemControl::use`
  /// has switched to the PLL, a countdown takes longer than `kCountdown`.
  static void start() {
    constexpr Bits<Control> kRunAndReset(0x3);
    kLoad.write(Bits<Load>(kCountdown.microseconds() * cycles_per_microsecond));
    kControl.write(kRunAndReset);
    kLock.write(kLocked);
  }

  static void feed() {
    kLock.write(kUnlocked);
    kClear.write(Bits<Clear>(1));  // any value clears the flag and restarts the countdown
    kLock.write(kLocked);
  }

  /// Resets the MCU. It does not tell this reset from that of a fault.
  [[noreturn]] static void restart() { cortex_m::Interrupts::reset(); }

 private:
  struct Load;
  struct Control;
  struct Clear;
  struct Lock;
  static constexpr Register<Load> kLoad{0x4000'0000};
  static constexpr Register<Control> kControl{0x4000'0008};
  static constexpr Register<Clear> kClear{0x4000'000C};
  static constexpr Register<Lock> kLock{0x4000'0C00};
  static constexpr Bits<Lock> kUnlocked{0x1ACC'E551};
  static constexpr Bits<Lock> kLocked{0};

  static constexpr Duration kCountdown = milliseconds(750);
  static_assert(2 * kCountdown.microseconds() < kWatchdogPeriod.microseconds(),
                "kCountdown is too long; two countdowns must take less than kWatchdogPeriod");
};

}  // namespace ex9000::hal::stellaris
