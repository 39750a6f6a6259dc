// Properties of the LM3S6965 and of the TM4C123GH6PM from their data sheets, and the crystals on their
// boards.
#pragma once

#include <cstdint>

#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

struct Chip {
  const char* name;
  unsigned ports;             ///< 6: A to F; 7: A to G
  bool port_control;          ///< GPIOPCTL and GPIOAMSEL exist
  bool i2c_clock_open_drain;  ///< true: the SCL pin must be open drain; false: it must not be open drain
  bool pin_clears_causes;     ///< a reset by the pin clears the other bits of RESC
  /// After software sets the bit of a clock gate, this number of clock cycles must pass before the first
  /// access to the peripheral.
  unsigned clocks_after_gate;
  Instant cycle_at_reset;  ///< period of the internal oscillator, whose frequency is 12 MHz or 16 MHz
  std::uint32_t rcc_at_reset;
  std::uint32_t rcc_kept;       ///< bits of RCC that must keep their value
  std::uint32_t crystal_code;   ///< value of RCC field XTAL for the crystal on the board
  std::uint32_t crystal_field;  ///< mask of RCC field XTAL, shifted to bit 0
};

/// LM3S6965 on its evaluation board, with an 8 MHz crystal.
inline constexpr Chip kLm3s6965{"LM3S6965",   7,     false, true, true, 3, Instant(83'333), 0x078E'3AD1U,
                                0x000E'0000U, 0x0EU, 0xFU};
/// TM4C123GH6PM on a LaunchPad, with a 16 MHz crystal.
inline constexpr Chip kTm4c123{"TM4C123GH6PM", 6, true,  false, false, 5, Instant(62'500),
                               0x078E'3AD1U,   0, 0x15U, 0x1FU};

}  // namespace ex9000::registers
