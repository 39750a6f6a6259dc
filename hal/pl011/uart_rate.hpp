// The baud-rate divisor of a PL011 UART, and the error of the resulting baud rate. Sources: LM3S6965 data
// sheet, 12.3.2; TM4C123GH6PM data sheet, 14.3.2; RP2040 data sheet, 4.2.7.1.
#pragma once

#include <cstdint>

#include "firmware/model/baud.hpp"

namespace ex9000::hal::pl011 {

/// Returns the divisor of the clock for 16 samples per bit, in units of 1/64: 16 integer bits and 6
/// fractional bits.
constexpr std::uint32_t baud_divisor(std::uint32_t clock, std::uint32_t baud) {
  return (4U * clock + baud / 2U) / baud;
}

/// Returns the deviation of the real baud rate from `baud`, in millionths of `baud`.
constexpr std::uint32_t baud_error(std::uint32_t clock, std::uint32_t baud) {
  const std::uint64_t wanted = std::uint64_t{baud} * baud_divisor(clock, baud);
  const std::uint64_t made = 4U * std::uint64_t{clock};
  return static_cast<std::uint32_t>((made > wanted ? made - wanted : wanted - made) * 1'000'000U / wanted);
}

/// Returns the largest `baud_error` of all baud rates of a module.
constexpr std::uint32_t largest_baud_error(std::uint32_t clock) {
  std::uint32_t largest = 0;
  for (const std::uint32_t baud : kBaudRates) {
    const std::uint32_t error = baud_error(clock, baud);
    largest = error > largest ? error : largest;
  }
  return largest;
}

/// The limit for the baud-rate error of the module, in millionths: the error must be smaller. With parity, a
/// receiver samples the stop bit 10.5 bits after the beginning of the start bit. The sum of the errors of the
/// sender and the receiver must therefore be less than 1/21. The limit for the module is about a fifth of
/// this value.
constexpr std::uint32_t kTolerableBaudError = 10'000;

}  // namespace ex9000::hal::pl011
