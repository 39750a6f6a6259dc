// Interrupt numbers. Source: RP2040 data sheet, 2.3.2.
#pragma once

#include <cstdint>

namespace ex9000::hal::rp2040 {

/// At equal priority, the lowest pending number runs first. The timers come before the UART, so that the end
/// of a silence is processed before the byte that follows it.
enum class Interrupt : std::uint8_t {
  Timer0 = 0,
  Timer1 = 1,
  Timer2 = 2,
  Pins = 13,
  Uart0 = 20,
  I2c0 = 23,
};

}  // namespace ex9000::hal::rp2040
