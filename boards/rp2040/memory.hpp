// The memories in which an image for an RP2040 can store its settings.
#pragma once

#include <cstdint>

namespace ex9000::board {

enum class Memory : std::uint8_t {
  Flash,   ///< the end of the flash that also contains the image
  Eeprom,  ///< an AT24C64 or a compatible FRAM on I2C
};

}  // namespace ex9000::board
