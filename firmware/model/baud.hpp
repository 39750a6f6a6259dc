// Baud-rate codes CC (manuals 1.10).
#pragma once

#include <array>
#include <cstdint>

namespace ex9000 {

constexpr std::uint8_t kFirstBaudCode = 0x03;
constexpr std::uint8_t kLastBaudCode = 0x0A;
constexpr std::uint8_t kFactoryBaudCode = 0x06;

/// Baud rates in bits per second of the codes 03 to 0A.
constexpr std::array<std::uint32_t, kLastBaudCode - kFirstBaudCode + 1> kBaudRates{
    1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};

constexpr bool is_baud_code(unsigned code) { return code >= kFirstBaudCode && code <= kLastBaudCode; }

/// Returns the baud rate of `code` in bits per second. `code` must be a baud-rate code.
constexpr std::uint32_t baud_rate(std::uint8_t code) { return kBaudRates[code - kFirstBaudCode]; }

}  // namespace ex9000
