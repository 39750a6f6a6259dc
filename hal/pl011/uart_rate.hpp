// The baud-rate divisor of a PL011 UART and its error. Sources: LM3S6965 data sheet, 12.3.2; TM4C123GH6PM
// data sheet, 14.3.2; RP2040 data sheet, 4.2.7.1.
#pragma once

#include <cstdint>

#include "firmware/model/baud.hpp"

namespace ex9000::hal::pl011 {

/// For 16 samples per bit, in units of 1/64: 16 integer bits and 6 fractional bits.
constexpr std::uint32_t baud_divisor(std::uint32_t clock, std::uint32_t baud) {
  return (4U * clock + baud / 2U) / baud;
}

/// Of the real baud rate, in millionths of `baud`.
constexpr std::uint32_t baud_error(std::uint32_t clock, std::uint32_t baud) {
  const std::uint64_t wanted = std::uint64_t{baud} * baud_divisor(clock, baud);
  const std::uint64_t made = 4U * std::uint64_t{clock};
  return static_cast<std::uint32_t>((made > wanted ? made - wanted : wanted - made) * 1'000'000U / wanted);
}

constexpr std::uint32_t largest_baud_error(std::uint32_t clock) {
  std::uint32_t largest = 0;
  for (const std::uint32_t baud : kBaudRates) {
    const std::uint32_t error = baud_error(clock, baud);
    largest = error > largest ? error : largest;
  }
  return largest;
}

/// In millionths; the error must be smaller. With parity, a receiver samples the stop bit 10.5 bits after the
/// start, so sender and receiver together must be off by less than 1/21. The module may use about a fifth.
constexpr std::uint32_t kTolerableBaudError = 10'000;

}  // namespace ex9000::hal::pl011
