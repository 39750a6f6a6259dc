// The interrupt controller of a Cortex-M3 or -M4, and waiting for it. Facts: ARMv7-M Architecture Reference
// Manual, B3.2 and B3.4.
#pragma once

#include <cstdint>

#include "hal/cortex_m/processor.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::cortex_m {

class Interrupts {
 public:
  /// `numbers`: a mask, bit n for interrupt n, of the first 32. Of priorities only the part counts that says
  /// which of several that wait comes first: none interrupts another, so the stack holds one at a time, and
  /// what interrupts share they need not guard. `last` comes behind all others, which go by their numbers,
  /// SysTick before them: a silence that is over is told before the byte that ends it.
  static void enable(std::uint32_t numbers, std::uint32_t last) {
    constexpr std::uint32_t kLowest = 0xFF;
    constexpr std::uint32_t kInterruptsAWord = 4;
    constexpr std::uint32_t kBits = 8;
    kApplicationInterrupt.write(kKey | kNoneInterrupts);
    Register<Priority>(0xE000'E400 + last / kInterruptsAWord * 4)
        .write(Bits<Priority>(kLowest << (last % kInterruptsAWord * kBits)));
    kSetEnable.write(Bits<SetEnable>(numbers));
  }

  /// Sleeps until `has_work()`; interrupts that bring none are served meanwhile. Main loop. They are held
  /// back only between the question and the sleep, so that none comes in between unseen; one that waits ends
  /// the sleep all the same.
  template <class HasWork>
  static void sleep_until(HasWork has_work) {
    processor::hold_interrupts();
    while (!has_work()) {
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

}  // namespace ex9000::hal::cortex_m
