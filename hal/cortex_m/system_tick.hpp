// SysTick as a periodic interrupt. Source: ARMv7-M Architecture Reference Manual, B3.3; ARMv6-M is the same.
#pragma once

#include <cstdint>

#include "hal/registers/register.hpp"
#include "hal/tick.hpp"

namespace ex9000::hal::cortex_m {

template <std::uint32_t cycles_per_microsecond>
class SystemTick {
 public:
  /// In clock cycles of the processor.
  static constexpr std::uint32_t kPeriod = kTickPeriod.microseconds() * cycles_per_microsecond;
  static_assert(kPeriod <= 1U << 24U, "the counter has 24 bits");

  static void start() {
    constexpr Bits<Control> kRunWithInterruptOnProcessorClock(0x7);
    kReload.write(Bits<Reload>(kPeriod - 1U));
    kCurrent.write({});
    kControl.write(kRunWithInterruptOnProcessorClock);
  }

 private:
  struct Control;
  struct Reload;
  struct Current;
  static constexpr Register<Control> kControl{0xE000'E010};
  static constexpr Register<Reload> kReload{0xE000'E014};
  static constexpr Register<Current> kCurrent{0xE000'E018};
};

}  // namespace ex9000::hal::cortex_m
