// The reset controller of the peripherals, and the power-on state machine, which can reset the second core.
// Source: RP2040 data sheet, 2.13 and 2.14.
#pragma once

#include <cstdint>

#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// The peripherals that images must reset or release from reset before their use. Each has one bit.
enum class Block : std::uint32_t {
  I2c0 = 1U << 3U,
  Pins = 1U << 5U,
  Pads = 1U << 8U,
  SystemPll = 1U << 12U,
  Timer = 1U << 21U,
  Uart0 = 1U << 22U,
};
constexpr std::uint32_t operator|(Block a, Block b) {
  return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b);
}
constexpr std::uint32_t operator|(std::uint32_t a, Block b) { return a | static_cast<std::uint32_t>(b); }

class Resets {
 public:
  /// Resets `blocks` and waits until they can be used. This takes a few clock cycles. If the clock of a block
  /// does not run, this function waits until the watchdog resets the MCU. Most blocks are already in reset
  /// before this call: the exceptions are the timer, which the boot ROM releases, and all blocks after a
  /// reset of only the processor, for example by a debug probe.
  static void restart(std::uint32_t blocks) {
    kReset.set(Bits<Reset>(blocks));
    kReset.clear(Bits<Reset>(blocks));
    while ((kDone.read().value() & blocks) != blocks) {
    }
  }

  /// Resets the second core, which may still run after a reset of only the first core. After this call, the
  /// second core sleeps in the boot ROM. This function does not keep the second core in reset, because a
  /// debug probe cannot connect to a core in reset.
  static void restart_second_core() {
    constexpr Bits<ForceOff> kSecondCore(1U << 16U);
    kForceOff.set(kSecondCore);
    while (!kForceOff.read().has(kSecondCore)) {
    }
    kForceOff.clear(kSecondCore);
  }

 private:
  struct Reset;
  struct Done;
  struct ForceOff;
  static constexpr SharedRegister<Reset> kReset{0x4000'C000};
  static constexpr SharedRegister<Done> kDone{0x4000'C008};
  static constexpr SharedRegister<ForceOff> kForceOff{0x4001'0004};
};

}  // namespace ex9000::hal::rp2040
