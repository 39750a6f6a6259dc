// SysTick as clock and tick. Source: ARMv7-M Architecture Reference Manual, B3.3 and B3.2.4 (ICSR).
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/time.hpp"
#include "hal/cortex_m/system_tick.hpp"
#include "hal/registers/register.hpp"
#include "hal/tick.hpp"

namespace ex9000::hal::cortex_m {

/// The interrupt counts ticks; the counter gives the microseconds since the last one.
template <std::uint32_t cycles_per_microsecond>
class SystemTimer {
 public:
  static void start() { SystemTick<cycles_per_microsecond>::start(); }

  [[nodiscard]] Time now() const {
    for (;;) {
      const std::uint32_t counted = counted_.load();
      const Time time = now_in_interrupt();
      if (counted == counted_.load()) {
        return time;
      }
    }
  }
  [[nodiscard, gnu::always_inline]] Time now_in_interrupt() const {
    constexpr Bits<InterruptControl> kPending(1U << 26U);
    std::uint32_t counted = counted_.load();
    std::uint32_t left = kCurrent.read().value();
    if (kInterruptControl.read().has(kPending)) {
      // The counter has restarted, but its interrupt has not run. `left` may be from before: read again.
      left = kCurrent.read().value();
      counted += kTickMicroseconds;
    }
    return Time(counted + kLastMicrosecond - left / cycles_per_microsecond);
  }

  /// From the SysTick interrupt.
  void count_in_interrupt() { counted_.store_in_interrupt(counted_.load() + kTickMicroseconds); }

 private:
  struct Current;
  struct InterruptControl;
  static constexpr Register<Current> kCurrent{0xE000'E018};
  static constexpr Register<InterruptControl> kInterruptControl{0xE000'ED04};
  static constexpr std::uint32_t kTickMicroseconds = kTickPeriod.microseconds();
  static constexpr std::uint32_t kLastMicrosecond = kTickMicroseconds - 1U;  // the counter counts down to 0

  WrittenByInterrupt<std::uint32_t> counted_;  ///< microseconds of all counted ticks
};

}  // namespace ex9000::hal::cortex_m
