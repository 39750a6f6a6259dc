// Interrupt numbers. Sources: LM3S6965 data sheet, 2.5 (vector table); TM4C123GH6PM data sheet, 2.5.
#pragma once

#include <cstdint>

namespace ex9000::hal::stellaris {

/// The same on the LM3S6965 and on the TM4C123GH6PM, which has no port G.
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
  GpioF = 30,
  GpioG = 31,
};

}  // namespace ex9000::hal::stellaris
