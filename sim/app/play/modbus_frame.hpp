// Modbus RTU frames for transcripts and tests.
#pragma once

#include <cstdint>
#include <vector>

namespace ex9000 {

/// Bit by bit (Modbus over Serial Line V1.02, 6.2.2), so as not to check the firmware with its own code.
inline std::vector<std::uint8_t> with_crc(std::vector<std::uint8_t> frame) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : frame) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = crc % 2 != 0;
      crc /= 2;
      crc ^= carry ? 0xA001U : 0U;
    }
  }
  frame.push_back(static_cast<std::uint8_t>(crc % 256));
  frame.push_back(static_cast<std::uint8_t>(crc / 256));
  return frame;
}

}  // namespace ex9000
