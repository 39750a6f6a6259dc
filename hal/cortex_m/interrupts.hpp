// Enables the interrupts of a Cortex-M, sleeps until an interrupt, and resets the microcontroller. Sources:
// ARMv7-M Architecture Reference Manual, B3.2 and B3.4; ARMv6-M Architecture Reference Manual, B3.2 and B3.4.
#pragma once

#include <cstdint>

#include "hal/cortex_m/processor.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::cortex_m {

class Interrupts {
 public:
  /// Enables interrupts. `numbers` is a mask; bit n is interrupt n, 0 to 31. `last` is the number of one of
  /// these interrupts.
  ///
  /// After this call, an interrupt cannot interrupt another interrupt. The stack therefore needs room for
  /// only one interrupt at a time, and interrupts can share data without protection. Priorities only define
  /// the order of pending interrupts: SysTick, then the others by number, then `last`. The board passes the
  /// UART as `last`, so that the end of a silence is processed before the byte that follows the silence. Do
  /// not call this overload on a Cortex-M0+, because there an interrupt can interrupt one of a lower
  /// priority.
  static void enable(std::uint32_t numbers, std::uint32_t last) {
    constexpr std::uint32_t kLowest = 0xFF;
    constexpr std::uint32_t kInterruptsAWord = 4;
    constexpr std::uint32_t kBits = 8;
    kApplicationInterrupt.write(kKey | kNoneInterrupts);
    Register<Priority>(0xE000'E400 + last / kInterruptsAWord * 4)
        .write(Bits<Priority>(kLowest << (last % kInterruptsAWord * kBits)));
    enable(numbers);
  }

  /// Enables interrupts without a change of their priorities. `numbers` is a mask as above. After a reset,
  /// all priorities are equal, so an interrupt cannot interrupt another interrupt, and pending interrupts run
  /// in this order: SysTick, then the others by number.
  static void enable(std::uint32_t numbers) { kSetEnable.write(Bits<SetEnable>(numbers)); }

  /// Sleeps until `has_work()` returns true. Interrupts are disabled during each call of `has_work` and
  /// during the sleep that may follow the call, so that no event is missed. A pending interrupt ends the
  /// sleep even if interrupts are disabled. It runs immediately after the sleep. For the main loop.
  template <class HasWork>
  static void sleep_until(HasWork has_work) {
    processor::disable_interrupts();
    while (!has_work()) {
      processor::wait_for_interrupt();
      processor::enable_interrupts();
      processor::disable_interrupts();
    }
    processor::enable_interrupts();
  }

  /// Resets the microcontroller immediately and does not return. Interrupts, faults and the main loop may
  /// call this. Do not call this on an RP2040, because the reset would affect only the processor.
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
