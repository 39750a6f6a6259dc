// CRC-16/MODBUS (Modbus over Serial Line V1.02, 2.5.1.2 and appendix B).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/bytes.hpp"

namespace ex9000 {

namespace detail {

/// What a half byte does to the CRC, for the lower and the upper half: 64 bytes of flash, two steps a byte.
/// One table of 256 entries would save four instructions a byte and cost 448 bytes more.
struct Crc16Table {
  std::array<std::uint16_t, 16> low;
  std::array<std::uint16_t, 16> high;
};

constexpr Crc16Table make_crc16_table() {
  constexpr unsigned kReflectedPolynomial = 0xA001;
  const auto shifted = [](unsigned crc) {
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
    }
    return static_cast<std::uint16_t>(crc);
  };
  Crc16Table table{};
  for (unsigned value = 0; value < table.low.size(); ++value) {
    table.low[value] = shifted(value);
    table.high[value] = shifted(value << 4U);
  }
  return table;
}

inline constexpr Crc16Table kCrc16Table = make_crc16_table();

}  // namespace detail

/// A CRC that grows with the bytes. Taken over a frame with its own CRC (low byte first) it comes to 0.
class Crc16 {
 public:
  constexpr Crc16() = default;
  /// One that nothing has been added to, and nothing may be.
  static constexpr Crc16 none() { return Crc16(0); }

  [[gnu::always_inline]] constexpr void add(std::uint8_t byte) {
    const std::uint32_t index = value_ ^ byte;
    value_ =
        (value_ >> 8U) ^ detail::kCrc16Table.low[index & 0xFU] ^ detail::kCrc16Table.high[index >> 4U & 0xFU];
  }
  /// 16 bits.
  [[nodiscard]] constexpr std::uint32_t value() const { return value_; }
  [[nodiscard]] constexpr std::uint8_t low_byte() const { return static_cast<std::uint8_t>(value_); }
  [[nodiscard]] constexpr std::uint8_t high_byte() const { return static_cast<std::uint8_t>(value_ >> 8U); }

 private:
  explicit constexpr Crc16(std::uint32_t value) : value_(value) {}

  std::uint32_t value_ = 0xFFFF;  // a word is what the processor calculates with
};

/// Of at least one byte.
constexpr Crc16 crc16(Bytes bytes) {
  Crc16 crc;
  const std::uint8_t* byte = bytes.begin();
  do {
    crc.add(*byte);
  } while (++byte != bytes.end());
  return crc;
}

}  // namespace ex9000
