// The interrupt controller of a Cortex-M3 or -M4, and waiting for it. Facts: ARMv7-M Architecture Reference
// Manual, B3.2 and B3.4.
#pragma once

#include <array>
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

/// Which of several that wait comes first, 0 to 7. None interrupts another (see `Interrupts::start`).
enum class Order : std::uint8_t { First = 0, Second = 1, Third = 2, Fourth = 3 };

/// An interrupt that is to be served; a handler of null: not by this image.
struct Served {
  Interrupt number;
  Order order;
  void (*handler)();
};

/// What the controller is to be told, worked out beforehand.
struct InterruptPlan {
  std::uint32_t enabled = 0;
  std::array<std::uint32_t, 6> priorities{};  ///< of 0 to 23, one byte each
};

template <class Table>
constexpr InterruptPlan plan(const Table& served) {
  constexpr unsigned kLowestPriorityBit = 5;
  InterruptPlan result;
  for (const Served& each : served) {
    const auto number = static_cast<unsigned>(each.number);
    if (each.handler != nullptr) {
      result.enabled |= 1U << number;
      result.priorities[number / 4] |= static_cast<std::uint32_t>(each.order)
                                       << (8U * (number % 4) + kLowestPriorityBit);
    }
  }
  return result;
}

class Interrupts {
 public:
  /// All priority bits order what waits and none lets one interrupt another: the stack holds one interrupt at
  /// a time, and what interrupts share they need not guard. Before the first `enable`.
  static void start() {
    constexpr Bits<ApplicationInterrupt> kKeyAndNoPreemption((0x05FAU << 16U) | (7U << 8U));
    kApplicationInterrupt.write(kKeyAndNoPreemption);
  }

  static void enable(const InterruptPlan& plan) {
    std::uint32_t address = kPriorities;
    for (const std::uint32_t word : plan.priorities) {
      Register<Priority>(address).write(Bits<Priority>(word));
      address += 4;
    }
    kSetEnable.write(Bits<SetEnable>(plan.enabled));
  }

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
  struct Priority;
  struct SetEnable;
  static constexpr std::uint32_t kPriorities = 0xE000'E400;
  static constexpr Register<SetEnable> kSetEnable{0xE000'E100};
  static constexpr Register<ApplicationInterrupt> kApplicationInterrupt{0xE000'ED0C};
};

}  // namespace ex9000::hal::stellaris
