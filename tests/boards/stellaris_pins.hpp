// The names of the pins of the Stellaris family, as in the wiring tables.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include EX9000_BOARD_HEADER

namespace ex9000::board {

/// Returns the name of a pin, for example "PA2".
inline std::string name_of(Pin pin) {
  return {'P', static_cast<char>('A' + static_cast<int>(pin.port)), static_cast<char>('0' + pin.number)};
}

template <class Groups>
std::vector<std::string> names_of(const Groups& groups) {
  std::vector<std::string> names;
  for (const PinGroup& group : groups) {
    for (unsigned i = 0; i < group.count; ++i) {
      names.push_back(name_of({group.port, static_cast<std::uint8_t>(group.first_pin + i)}));
    }
  }
  return names;
}

/// Returns the names of the pins of the UART and of the EEPROM, by signal.
inline std::map<std::string, std::string> names_of_peripherals() {
  return {{"receive", name_of({kUartPins.port, kUartPins.first_pin})},
          {"transmit", name_of({kUartPins.port, static_cast<std::uint8_t>(kUartPins.first_pin + 1)})},
          {"EEPROM clock", "PB2"},  // I2C0 has these pins on the LM3S6965 and on the TM4C123
          {"EEPROM data", "PB3"}};
}

/// JTAG uses PC0 to PC3, and on the LM3S6965 also PB7. A resistor joins PB7 and PD1 on the EK-TM4C123GXL. The
/// README of the EK-TM4C123GXL lists more pins that a module does not use.
inline const std::array<std::string, 5> kReservedPins{"PC0", "PC1", "PC2", "PC3", "PB7"};

}  // namespace ex9000::board
