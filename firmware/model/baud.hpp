// Baud codes CC: bits 5:0 the rate (manuals 1.10), bits 7:6 the line format (firmware/extensions.md).
// `baud_rate` and `line_format` take only valid codes.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/line_format.hpp"

namespace ex9000 {

constexpr std::uint8_t kFirstBaudCode = 0x03;
constexpr std::uint8_t kLastBaudCode = 0x0A;
constexpr std::uint8_t kFactoryBaudCode = 0x06;
constexpr std::uint8_t kRateBits = 0x3F;
constexpr unsigned kFormatShift = 6;
/// The last rate with the last format.
constexpr std::uint8_t kLargestBaudCode = 0xC0 | kLastBaudCode;

/// Codes 03 to 0A, in bits per second.
constexpr std::array<std::uint32_t, kLastBaudCode - kFirstBaudCode + 1> kBaudRates{
    1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};

constexpr bool is_baud_code(unsigned code) {
  const unsigned rate = code & kRateBits;
  return code <= kLargestBaudCode && rate >= kFirstBaudCode && rate <= kLastBaudCode;
}

constexpr std::uint32_t baud_rate(std::uint8_t code) {
  return kBaudRates[(code & kRateBits) - kFirstBaudCode];
}

constexpr LineFormat line_format(std::uint8_t code) { return static_cast<LineFormat>(code >> kFormatShift); }

constexpr std::uint8_t with_line_format(std::uint8_t code, LineFormat format) {
  return static_cast<std::uint8_t>((code & kRateBits) | static_cast<unsigned>(format) << kFormatShift);
}

}  // namespace ex9000
