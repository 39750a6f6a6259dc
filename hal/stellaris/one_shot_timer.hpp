// A general-purpose timer, one-shot, 32 bits. Sources: LM3S6965 data sheet, 9.3-9.5; TM4C123GH6PM, 11.3-11.5.
#pragma once

#include <cstdint>

#include "firmware/time.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::stellaris {

/// `number`: 0 to 3 for GPTM0 to GPTM3. `cycles_per_microsecond`: system clock in MHz.
template <unsigned number, std::uint32_t cycles_per_microsecond>
class OneShotTimer {
 public:
  /// After reset, the timer is stopped and 32 bits wide.
  static void start() {
    constexpr Bits<Mode> kOneShot(0x1);
    kMode.write(kOneShot);
    kInterruptMask.write(kTimeout);
  }

  static void restart(Duration after) {
    kControl.write({});
    kInterruptClear.write(kTimeoutClear);
    kInterval.write(Bits<Interval>(after.microseconds() * cycles_per_microsecond));
    kControl.write(kEnable);
  }

  static bool take_expiry() {
    if (!kMaskedInterrupts.read().has(kHasTimedOut)) {
      return false;
    }
    kInterruptClear.write(kTimeoutClear);
    return true;
  }

 private:
  struct Mode;
  struct Control;
  struct InterruptMask;
  struct MaskedInterrupts;
  struct InterruptClear;
  struct Interval;
  static constexpr Bits<Control> kEnable{1U << 0U};
  static constexpr Bits<InterruptMask> kTimeout{1U << 0U};
  static constexpr Bits<MaskedInterrupts> kHasTimedOut{1U << 0U};
  static constexpr Bits<InterruptClear> kTimeoutClear{1U << 0U};

  static constexpr std::uint32_t kBase = 0x4003'0000U + number * 0x1000U;
  static constexpr Register<Mode> kMode{kBase + 0x004};
  static constexpr Register<Control> kControl{kBase + 0x00C};
  static constexpr Register<InterruptMask> kInterruptMask{kBase + 0x018};
  static constexpr Register<MaskedInterrupts> kMaskedInterrupts{kBase + 0x020};
  static constexpr Register<InterruptClear> kInterruptClear{kBase + 0x024};
  static constexpr Register<Interval> kInterval{kBase + 0x028};
};

}  // namespace ex9000::hal::stellaris
