// The interrupt controller of a Cortex-M3 or -M4, and waiting for it. Facts: ARMv7-M Architecture Reference
// Manual, B3.2 and B3.4.
#pragma once

#include <cstdint>

#include "hal/stellaris/processor.hpp"
#include "hal/stellaris/register.hpp"

namespace ex9000::hal::stellaris {

/// Interrupt numbers; the same on both families.
enum class Interrupt : std::uint8_t {
  GpioA = 0,
  GpioB = 1,
  GpioC = 2,
  GpioD = 3,
  GpioE = 4,
  Uart0 = 5,
  Uart1 = 6,
  I2c0 = 8,
  Timer0A = 19,
  Timer1A = 21,
};

class Interrupts {
 public:
  /// `numbers`: a mask, bit n for interrupt n. All keep the priority that they have after reset, the same for
  /// all: none interrupts another, so the stack holds one at a time, and what interrupts share they need not
  /// guard. Where several wait, SysTick comes first, then the one with the lowest number.
  static void enable(std::uint32_t numbers) { kSetEnable.write(Bits<SetEnable>(numbers)); }

  /// Sleeps until `news()`; interrupts that bring none are served meanwhile. Main loop. They are held back
  /// only between the question and the sleep, so that none comes in between unseen; one that waits ends the
  /// sleep all the same.
  template <class News>
  static void sleep_until(News news) {
    for (;;) {
      processor::hold_interrupts();
      const bool any = news();
      if (!any) {
        processor::wait_for_interrupt();
      }
      processor::release_interrupts();
      if (any) {
        return;
      }
    }
  }

  /// Resets the microcontroller at once. Anywhere; does not return.
  [[noreturn]] static void reset() {
    constexpr Bits<ApplicationInterrupt> kKeyAndReset((0x05FAU << 16U) | (1U << 2U));
    kApplicationInterrupt.write(kKeyAndReset);
    for (;;) {
    }
  }

 private:
  struct ApplicationInterrupt;
  struct SetEnable;
  static constexpr Register<SetEnable> kSetEnable{0xE000'E100};
  static constexpr Register<ApplicationInterrupt> kApplicationInterrupt{0xE000'ED0C};
};

}  // namespace ex9000::hal::stellaris
