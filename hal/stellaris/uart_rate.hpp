// Baud rates that the UART's divisor can make. Facts: LM3S6965 data sheet, 12.3.2; TM4C123GH6PM data sheet,
// 14.3.2.
#pragma once

#include <cstdint>

#include "firmware/model/baud.hpp"

namespace ex9000::hal::stellaris {

/// The clock's divisor for 16 samples a bit, in 64ths: 16 bits before the point and 6 behind it.
constexpr std::uint32_t baud_divisor(std::uint32_t clock, std::uint32_t baud) {
  return (4U * clock + baud / 2U) / baud;
}

/// How far the rate that comes out lies from `baud`, in millionths of it.
constexpr std::uint32_t baud_error(std::uint32_t clock, std::uint32_t baud) {
  const std::uint64_t wanted = std::uint64_t{baud} * baud_divisor(clock, baud);
  const std::uint64_t made = 4U * std::uint64_t{clock};
  return static_cast<std::uint32_t>((made > wanted ? made - wanted : wanted - made) * 1'000'000U / wanted);
}

/// The largest of all the rates that a module can be set to, in millionths.
constexpr std::uint32_t largest_baud_error(std::uint32_t clock) {
  std::uint32_t largest = 0;
  for (const std::uint32_t baud : kBaudRates) {
    const std::uint32_t error = baud_error(clock, baud);
    largest = error > largest ? error : largest;
  }
  return largest;
}

/// A receiver samples the stop bit 9.5 bits behind the start bit's edge, so both ends together may be off by
/// a twentieth; this end takes a fifth of that.
constexpr std::uint32_t kTolerableBaudError = 10'000;

}  // namespace ex9000::hal::stellaris
