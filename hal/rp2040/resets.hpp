// Resets of the peripherals and (power-on state machine) of the second core. RP2040 data sheet, 2.13, 2.14.
#pragma once

#include <cstdint>

#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// What images must reset, or release from reset, before use.
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
  /// Waits a few clock cycles until `blocks` can be used; without a block's clock, until the watchdog resets
  /// the MCU. Most are in reset already, except the timer, which the boot ROM releases, and all of them after
  /// a reset of only the processor, for example by a debug probe.
  static void restart(std::uint32_t blocks) {
    kReset.set(Bits<Reset>(blocks));
    kReset.clear(Bits<Reset>(blocks));
    while ((kDone.read().value() & blocks) != blocks) {
    }
  }

  /// It may still run after a reset of only the first core; then it sleeps in the boot ROM. It is not kept in
  /// reset, because a debug probe could not connect to it.
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
