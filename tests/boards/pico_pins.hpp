// The names of the pins of a Pico, as in the wiring tables.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include EX9000_BOARD_HEADER
#include "hal/pins/single_pins.hpp"

namespace ex9000::board {

inline std::string name_of(unsigned number) { return "GP" + std::to_string(number); }
inline std::string name_of(Pin pin) { return name_of(pin.number); }
inline std::string name_of(hal::NoPin /*pin*/) { return "–"; }

template <class Groups>
std::vector<std::string> names_of(const Groups& groups) {
  std::vector<std::string> names;
  for (const PinGroup& group : groups) {
    for (unsigned i = 0; i < group.count; ++i) {
      names.push_back(name_of(group.first_pin + i));
    }
  }
  return names;
}

/// Returns the names of the pins of the UART and, if the board can have one, of the EEPROM, by signal. The
/// checks of the pins follow the RP2040 data sheet, 1.4.3.
inline std::map<std::string, std::string> names_of_peripherals() {
  static_assert(kUartPins.first_pin % 16 == 0 || kUartPins.first_pin % 16 == 12,
                "the UART pins must be TX and RX of UART0");
  static_assert(kI2cPins.first_pin % 4 == 0, "the I2C pins must be SDA and SCL of I2C0");
  return {{"transmit", name_of(kUartPins.first_pin)},
          {"receive", name_of(kUartPins.first_pin + 1U)},
#ifndef EX9000_BOARD_HAS_NO_EEPROM
          {"EEPROM data", name_of(kI2cPins.first_pin)},
          {"EEPROM clock", name_of(kI2cPins.first_pin + 1U)}
#endif
  };
}

/// The power supply of the Pico (Raspberry Pi Pico data sheet, 2.1) or the radio of the Pico W uses these
/// pins. The radio also uses GP25, which is not in this list because the status LED of the Pico is at GP25.
inline const std::array<std::string, 3> kReservedPins{"GP23", "GP24", "GP29"};

/// The GPIO at each position of a Pico, from position 1 on (Raspberry Pi Pico data sheet, 2.1). An empty text
/// marks a position without a GPIO.
inline const std::array<std::string, 40> kPositions{
    "GP0",  "GP1",  "", "GP2",  "GP3",  "GP4",  "GP5",  "", "GP6",  "GP7",
    "GP8",  "GP9",  "", "GP10", "GP11", "GP12", "GP13", "", "GP14", "GP15",
    "GP16", "GP17", "", "GP18", "GP19", "GP20", "GP21", "", "GP22", "",
    "GP26", "GP27", "", "GP28", "",     "",     "",     "", "",     ""};

}  // namespace ex9000::board
