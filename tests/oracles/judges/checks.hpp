// The CRC of Modbus and the checksum of DCON, computed from their definitions. This file shares no code with
// the firmware, so that the tests do not check the firmware with its own code.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace ex9000::judges {

namespace detail {

/// Returns, for each value of `bits` bits, the result of `bits` shifts of a reflected CRC.
template <class Crc, unsigned bits>
constexpr std::array<Crc, 1U << bits> crc_table(Crc polynomial) {
  std::array<Crc, 1U << bits> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    auto crc = static_cast<Crc>(i);
    for (unsigned bit = 0; bit < bits; ++bit) {
      crc = static_cast<Crc>(crc % 2 != 0 ? crc / 2 ^ polynomial : crc / 2);
    }
    table[i] = crc;
  }
  return table;
}

inline constexpr auto kCrc16 = crc_table<std::uint16_t, 8>(0xA001);

}  // namespace detail

/// Returns the CRC-16/MODBUS of the bytes. It is 0 if the bytes are a frame that includes its correct CRC.
inline std::uint16_t crc16(const std::uint8_t* bytes, std::size_t size) {
  unsigned crc = 0xFFFF;
  for (std::size_t i = 0; i < size; ++i) {
    crc = crc / 256 ^ detail::kCrc16[(crc ^ bytes[i]) % 256];
  }
  return static_cast<std::uint16_t>(crc);
}

/// Returns the sum of all characters, modulo 256.
inline std::uint8_t dcon_sum(const std::uint8_t* text, std::size_t size) {
  unsigned sum = 0;
  for (std::size_t i = 0; i < size; ++i) {
    sum += text[i];
  }
  return static_cast<std::uint8_t>(sum % 256);
}

/// Returns the upper-case hex digit of `value` modulo 16.
constexpr std::uint8_t upper_hex(unsigned value) {
  return static_cast<std::uint8_t>("0123456789ABCDEF"[value % 16]);
}

/// Returns whether the first two characters of `text` are `value` modulo 256 in upper-case hex digits.
constexpr bool are_digits_of(const std::uint8_t* text, unsigned value) {
  return text[0] == upper_hex(value / 16) && text[1] == upper_hex(value);
}

}  // namespace ex9000::judges
