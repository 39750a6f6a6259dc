// In what the two microcontrollers differ, as their data sheets have it.
#pragma once

#include <cstdint>

#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

struct Chip {
  const char* name;
  unsigned ports;              ///< A to F, or A to G
  bool port_control;           ///< GPIOPCTL and GPIOAMSEL exist
  bool i2c_clock_open_drain;   ///< the pin of SCL must be made open drain; else it must not
  unsigned clocks_after_gate;  ///< between a clock gate and the first access behind it
  Instant cycle_at_reset;      ///< of the internal oscillator: 12 MHz on one, 16 MHz on the other
  std::uint32_t rcc_at_reset;
  std::uint32_t rcc_kept;       ///< bits of RCC that have no meaning and keep what they were
  std::uint32_t crystal_code;   ///< RCC field XTAL of the crystal on its board
  std::uint32_t crystal_field;  ///< of RCC, shifted down
};

/// LM3S6965 on its evaluation board, with 8 MHz.
inline constexpr Chip kLm3s6965{"LM3S6965",   7,     false, true, 3, Instant(83'333), 0x078E'3AD1U,
                                0x000E'1000U, 0x0EU, 0xFU};
/// TM4C123GH6PM on a LaunchPad, with 16 MHz.
inline constexpr Chip kTm4c123{"TM4C123GH6PM", 6,     true, false, 5, Instant(62'500), 0x078E'3AD1U,
                               0x0000'1000U,   0x15U, 0x1FU};

}  // namespace ex9000::registers
