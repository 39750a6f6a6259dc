// CRC-32, which guards the stored settings.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"

namespace ex9000 {

/// CRC-32 as IEEE 802.3, 3.2.9 defines it, over bytes that come one after the other. It is computed bit by
/// bit, without a table, because settings are loaded and stored rarely: some 60 instructions a byte.
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
