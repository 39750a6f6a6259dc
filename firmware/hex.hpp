// Hex digits of DCON: 0 to 9 and A to F, upper case only. The value of any other character is -1.
#pragma once

#include <cstdint>

namespace ex9000 {

constexpr int hex_value(std::uint8_t character) {
  if (character >= '0' && character <= '9') {
    return character - '0';
  }
  if (character >= 'A' && character <= 'F') {
    return character - 'A' + 10;
  }
  return -1;
}

constexpr int hex_byte(std::uint8_t high, std::uint8_t low) {
  const int upper = hex_value(high);
  const int lower = hex_value(low);
  return upper < 0 || lower < 0 ? -1 : upper * 16 + lower;
}

constexpr std::uint8_t hex_digit(unsigned value) {
  return static_cast<std::uint8_t>("0123456789ABCDEF"[value & 0xFU]);
}

/// The high digit, the first one in a text, is in the low byte.
constexpr std::uint16_t hex_digits(std::uint8_t value) {
  return static_cast<std::uint16_t>(hex_digit(value >> 4U) | hex_digit(value) << 8U);
}

}  // namespace ex9000
