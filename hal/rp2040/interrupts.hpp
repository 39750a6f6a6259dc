// Interrupt numbers. Source: RP2040 data sheet, 2.3.2.
#pragma once

#include <cstdint>

namespace ex9000::hal::rp2040 {

/// The processor serves pending interrupts of equal priority in the order of their numbers, the lowest number
/// first. The timers have lower numbers than the UART, so the end of a silence is processed before the byte
/// that follows the silence.
enum class Interrupt : std::uint8_t {
  Timer0 = 0,
  Timer1 = 1,
  Timer2 = 2,
  Pins = 13,
  Uart0 = 20,
  I2c0 = 23,
};

}  // namespace ex9000::hal::rp2040
