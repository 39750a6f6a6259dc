// The format of a character on the line.
#pragma once

#include <cstdint>

namespace ex9000 {

/// Every format has a start bit and 8 data bits. The values are bits 7:6 of the baud-rate code CC
/// (firmware/extensions.md).
enum class LineFormat : std::uint8_t {
  k8N1,  ///< no parity, one stop bit
  k8N2,  ///< no parity, two stop bits
  k8E1,  ///< even parity, one stop bit
  k8O1,  ///< odd parity, one stop bit
};

constexpr bool has_parity(LineFormat format) {
  return format == LineFormat::k8E1 || format == LineFormat::k8O1;
}

/// Returns the duration of a character in bits, from the start bit to the last stop bit.
constexpr unsigned bits_of_character(LineFormat format) { return format == LineFormat::k8N1 ? 10 : 11; }

/// Returns the number of bits of a character that a receiver reads: a receiver ignores the second stop bit.
constexpr unsigned bits_received(LineFormat format) { return has_parity(format) ? 11 : 10; }

}  // namespace ex9000
