// Registers of UART0 of the LM3S6965, for code that accesses them from outside the microcontroller.
// Source: LM3S6965 data sheet, section 12.5.
#pragma once

#include <cstdint>

namespace ex9000::rig {

inline constexpr std::uint32_t kUart0 = 0x4000'C000;
inline constexpr std::uint32_t kUartIntegerDivisor = 0x24;
inline constexpr std::uint32_t kUartFractionalDivisor = 0x28;
inline constexpr std::uint32_t kUartLineControl = 0x2C;
inline constexpr std::uint32_t kUartFifosOn = 0x10;  ///< in line control
inline constexpr std::uint32_t kUartControl = 0x30;
inline constexpr std::uint32_t kUartEnabled = 1;             ///< in control
inline constexpr std::uint32_t kUartControlAtReset = 0x300;  ///< in control
inline constexpr std::uint32_t kUartInterruptMask = 0x38;

}  // namespace ex9000::rig
