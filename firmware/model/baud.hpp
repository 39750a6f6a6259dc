// Baud-rate codes CC (manuals 1.10) and what follows from a rate.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/time.hpp"

namespace ex9000 {

constexpr std::uint8_t kFirstBaudCode = 0x03;
constexpr std::uint8_t kLastBaudCode = 0x0A;
constexpr std::uint8_t kFactoryBaudCode = 0x06;

/// Bits per second of the codes 03 to 0A.
constexpr std::array<std::uint32_t, kLastBaudCode - kFirstBaudCode + 1> kBaudRates{
    1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};

constexpr bool is_baud_code(unsigned code) { return code >= kFirstBaudCode && code <= kLastBaudCode; }

/// `code` must be a baud code.
constexpr std::uint32_t baud_rate(std::uint8_t code) { return kBaudRates[code - kFirstBaudCode]; }

/// The times a receiver needs at one rate.
struct LineTiming {
  Duration character;  ///< one character, 10 bits: start, 8 data, stop; rounded up
  Duration
      rtu_silence;  ///< T3.5, the silence that ends a Modbus RTU frame; rounded up, so a reply is never early
  Duration
      rtu_separate;  ///< two bytes whose ends lie at least this far apart belong to two frames: T3.5 and the
                     ///< second byte itself; rounded down, so a frame after exactly T3.5 is one of its own
  Duration
      rtu_slack;  ///< likewise for T1.5: bytes further apart break the standard within a frame; rounded up

  /// Modbus over Serial Line V1.02, 2.5.1.1: T1.5 and T3.5 count 11-bit characters up to 19200 baud and are
  /// fixed above. `baud` in bits per second, 1200 to 115200.
  static constexpr LineTiming at(std::uint32_t baud) {
    constexpr std::uint32_t kHalfSecond = 500'000;
    constexpr std::uint32_t kCharacter = 2 * 10;  // half bits
    constexpr std::uint32_t kT15 = 3 * 11;
    constexpr std::uint32_t kT35 = 7 * 11;
    constexpr std::uint32_t kFixedTimesAbove = 19200;
    const std::uint32_t character = kCharacter * kHalfSecond / baud;
    const bool fixed = baud > kFixedTimesAbove;
    const std::uint32_t t15 = fixed ? 750 : kT15 * kHalfSecond / baud;
    const std::uint32_t t35 = fixed ? 1750 : kT35 * kHalfSecond / baud;
    constexpr std::uint32_t kRoundUp =
        2;  // one for the division, one for a clock that shows whole microseconds
    return {Duration(character + kRoundUp), Duration(t35 + kRoundUp), Duration(t35 + character - 1),
            Duration(t15 + character + kRoundUp)};
  }
};

}  // namespace ex9000
