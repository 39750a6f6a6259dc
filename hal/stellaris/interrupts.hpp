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
  Timer2A = 23,
};

class Interrupts {
 public:
  /// `numbers`: a mask, bit n for interrupt n. Of priorities only the part counts that says which of several
  /// that wait comes first: none interrupts another, so the stack holds one at a time, and what interrupts
  /// share they need not guard. `last` comes behind all others, which go by their numbers, SysTick before
  /// them: a silence that is over is told before the byte that ends it.
  static void enable(std::uint32_t numbers, Interrupt last) {
    constexpr std::uint32_t kLowest = 0xFF;
    constexpr std::uint32_t kInterruptsAWord = 4;
    constexpr std::uint32_t kBits = 8;
    const auto number = static_cast<std::uint32_t>(last);
    kApplicationInterrupt.write(kKey | kNoneInterrupts);
    Register<Priority>(0xE000'E400 + number / kInterruptsAWord * 4)
        .write(Bits<Priority>(kLowest << (number % kInterruptsAWord * kBits)));
    kSetEnable.write(Bits<SetEnable>(numbers));
  }

  /// Sleeps until `news()`; interrupts that bring none are served meanwhile. Main loop. They are held back
  /// only between the question and the sleep, so that none comes in between unseen; one that waits ends the
  /// sleep all the same.
  template <class News>
  static void sleep_until(News news) {
    processor::hold_interrupts();
    while (!news()) {
      processor::wait_for_interrupt();
      processor::release_interrupts();
      processor::hold_interrupts();
    }
    processor::release_interrupts();
  }

  /// Resets the microcontroller at once. Anywhere; does not return.
  [[noreturn]] static void reset() {
    constexpr Bits<ApplicationInterrupt> kReset(1U << 2U);
    kApplicationInterrupt.write(kKey | kReset);
    for (;;) {
    }
  }

 private:
  struct ApplicationInterrupt;
  struct SetEnable;
  struct Priority;
  static constexpr Register<SetEnable> kSetEnable{0xE000'E100};
  static constexpr Register<ApplicationInterrupt> kApplicationInterrupt{0xE000'ED0C};
  static constexpr Bits<ApplicationInterrupt> kKey{0x05FAU << 16U};
  static constexpr Bits<ApplicationInterrupt> kNoneInterrupts{0x7U << 8U};  // PRIGROUP
};

}  // namespace ex9000::hal::stellaris
