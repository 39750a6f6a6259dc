// The CRC-32 of the stored settings: IEEE 802.3, 3.2.9.
#pragma once

#include <cstdint>

namespace ex9000 {

class Crc32 {
 public:
  constexpr void add(std::uint8_t byte) {
    constexpr unsigned kBits = 8;
    constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320;
    crc_ ^= byte;
    for (unsigned bit = 0; bit < kBits; ++bit) {
      crc_ = (crc_ & 1U) != 0 ? (crc_ >> 1U) ^ kReflectedPolynomial : crc_ >> 1U;
    }
  }

  [[nodiscard]] constexpr std::uint32_t value() const { return ~crc_; }

 private:
  std::uint32_t crc_ = 0xFFFF'FFFF;
};

}  // namespace ex9000
