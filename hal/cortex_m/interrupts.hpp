// Cortex-M interrupts, sleep, reset. Sources: ARMv7-M, ARMv6-M Architecture Reference Manual, B3.2, B3.4.
#pragma once

#include <cstdint>

#include "hal/cortex_m/processor.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::cortex_m {

class Interrupts {
 public:
  /// Bit n of `numbers` is interrupt n, 0 to 31; `last` is one of them. No interrupt can then interrupt
  /// another: the stack needs room for only one, and they share data without protection. Priorities only
  /// order pending ones: SysTick, the others by number, then `last`. The board passes the UART, so that the
  /// end of a silence comes before the byte that follows it. Not on a Cortex-M0+, where an interrupt can
  /// interrupt one of a lower priority.
  static void enable(std::uint32_t numbers, std::uint32_t last) {
    constexpr std::uint32_t kLowest = 0xFF;
    constexpr std::uint32_t kInterruptsAWord = 4;
    constexpr std::uint32_t kBits = 8;
    kApplicationInterrupt.write(kKey | kNoneInterrupts);
    Register<Priority>(0xE000'E400 + last / kInterruptsAWord * 4)
        .write(Bits<Priority>(kLowest << (last % kInterruptsAWord * kBits)));
    enable(numbers);
  }

  /// Keeps the priorities. They are equal after a reset, so no interrupt can interrupt another, and pending
  /// ones run in the order SysTick, then by number.
  static void enable(std::uint32_t numbers) { kSetEnable.write(Bits<SetEnable>(numbers)); }

  /// For the main loop. `has_work` and the sleep run with interrupts disabled, so that no event is missed. A
  /// pending interrupt still ends the sleep, and runs right after it.
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

  /// For interrupts, faults and the main loop. Not on an RP2040, where it would reset only the processor.
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
