// CRC-16/MODBUS (Modbus over Serial Line V1.02, 2.5.1.2 and appendix B).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/bytes.hpp"

namespace ex9000 {

namespace detail {

/// One entry a byte value: 512 bytes of flash buy a byte's CRC in a handful of instructions, which the
/// receive interrupt pays for every byte.
constexpr std::array<std::uint16_t, 256> make_crc16_table() {
  constexpr std::uint16_t kReflectedPolynomial = 0xA001;
  std::array<std::uint16_t, 256> table{};
  for (unsigned value = 0; value < table.size(); ++value) {
    unsigned crc = value;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
    }
    table[value] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

inline constexpr std::array<std::uint16_t, 256> kCrc16Table = make_crc16_table();

}  // namespace detail

/// A CRC that grows with the bytes. Taken over a frame with its own CRC (low byte first) it comes to 0.
class Crc16 {
 public:
  constexpr void add(std::uint8_t byte) {
    value_ = static_cast<std::uint16_t>((value_ >> 8U) ^ detail::kCrc16Table[(value_ ^ byte) & 0xFFU]);
  }
  [[nodiscard]] constexpr std::uint16_t value() const { return value_; }
  [[nodiscard]] constexpr std::uint8_t low_byte() const { return static_cast<std::uint8_t>(value_); }
  [[nodiscard]] constexpr std::uint8_t high_byte() const { return static_cast<std::uint8_t>(value_ >> 8U); }

 private:
  std::uint16_t value_ = 0xFFFF;
};

constexpr Crc16 crc16(Bytes bytes) {
  Crc16 crc;
  for (const std::uint8_t byte : bytes) {
    crc.add(byte);
  }
  return crc;
}

}  // namespace ex9000
