// What an RP2040 with a flash of 2 MiB stores, and where. Addresses in the flash are offsets in bytes.
#pragma once

#include <cstdint>

namespace ex9000::board {

/// The second stage has the first 256 bytes of the flash, the loader the rest of the sector.
inline constexpr std::uint32_t kLoaderInFlash = 256;
/// Slot 0, then slot 1: firmware/update/slot.hpp.
inline constexpr std::uint32_t kSlotsInFlash = 0x1'0000;

/// Where images run.
inline constexpr std::uint32_t kImageInRam = 0x2000'0000;

/// The memories in which an image can store its settings.
enum class Memory : std::uint8_t {
  Flash,   ///< the end of the flash that also contains the image
  Eeprom,  ///< an AT24C64 or a compatible FRAM on I2C
};

}  // namespace ex9000::board
