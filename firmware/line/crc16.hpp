// CRC-16/MODBUS (Modbus over Serial Line V1.02, 2.5.1.2 and appendix B).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/bytes.hpp"

namespace ex9000 {

namespace detail {

using Crc16Table = std::array<std::uint16_t, 256>;

/// The effect of each byte value on the CRC.
constexpr Crc16Table make_crc16_table() {
  constexpr unsigned kReflectedPolynomial = 0xA001;
  Crc16Table table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned crc = byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
    }
    table[byte] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

inline constexpr Crc16Table kCrc16Table = make_crc16_table();

}  // namespace detail

/// Byte by byte. The CRC of a frame that includes its CRC (low byte first) is 0.
class Crc16 {
 public:
  constexpr void add(std::uint8_t byte) {
    value_ = (value_ >> 8U) ^ detail::kCrc16Table[(value_ ^ byte) & 0xFFU];
  }
  [[nodiscard]] constexpr std::uint32_t value() const { return value_; }
  [[nodiscard]] constexpr std::uint8_t low_byte() const { return static_cast<std::uint8_t>(value_); }
  [[nodiscard]] constexpr std::uint8_t high_byte() const { return static_cast<std::uint8_t>(value_ >> 8U); }

 private:
  std::uint32_t value_ = 0xFFFF;  // 16 bits in a word, because the processor calculates with 32-bit words
};

constexpr Crc16 crc16(Bytes bytes) {
  Crc16 crc;
  for (const std::uint8_t byte : bytes) {
    crc.add(byte);
  }
  return crc;
}

}  // namespace ex9000
