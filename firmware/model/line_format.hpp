// The format of a character on the line.
#pragma once

#include <cstdint>

namespace ex9000 {

/// Each: a start bit and 8 data bits. The values are bits 7:6 of the baud code CC (firmware/extensions.md).
enum class LineFormat : std::uint8_t {
  k8N1,  ///< no parity, one stop bit
  k8N2,  ///< no parity, two stop bits
  k8E1,  ///< even parity, one stop bit
  k8O1,  ///< odd parity, one stop bit
};

constexpr bool has_parity(LineFormat format) {
  return format == LineFormat::k8E1 || format == LineFormat::k8O1;
}

/// From the start bit to the last stop bit.
constexpr unsigned bits_of_character(LineFormat format) { return format == LineFormat::k8N1 ? 10 : 11; }

/// A receiver ignores the second stop bit.
constexpr unsigned bits_received(LineFormat format) { return has_parity(format) ? 11 : 10; }

}  // namespace ex9000
