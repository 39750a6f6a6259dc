// The times that depend on the baud rate and the line format: an independent implementation of wire.md 3, 7
// and 12.
#pragma once

#include <cstdint>

#include "firmware/model/line_format.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

/// All times are in microseconds, rounded down. A UART reports a byte at the end of the byte's first stop
/// bit, and the judges receive the byte at this time. With 8N2, a second stop bit follows the report.
struct LineTimes {
  Microseconds character = 0;    ///< from the start bit to the end of the last stop bit
  Microseconds received = 0;     ///< from the start bit to the end of the first stop bit
  Microseconds rest = 0;         ///< from the end of the first stop bit to the end of the last one
  Microseconds t35 = 0;          ///< T3.5, the silence that ends an RTU frame
  Microseconds turn_around = 0;  ///< least time from the report of CR to an ASCII reply
  Microseconds silence = 0;      ///< from the report of a byte to the end of the T3.5 that follows the byte
  Microseconds slack = 0;        ///< time between the reports of two bytes with a gap of T1.5

  static constexpr LineTimes at(std::uint32_t baud, LineFormat format) {
    constexpr unsigned kStartDataStop = 10;
    const unsigned parity = format == LineFormat::k8E1 || format == LineFormat::k8O1 ? 1 : 0;
    const unsigned second_stop = format == LineFormat::k8N2 ? 1 : 0;
    const unsigned all = kStartDataStop + parity + second_stop;
    const auto half_bits = [baud](unsigned count) { return count * 500'000ULL / baud; };
    // Up to 19200 baud, T1.5 and T3.5 are 1.5 and 3.5 characters of 11 bits in every format. Above 19200 baud
    // they are fixed.
    const bool fixed = baud > 19200;
    LineTimes times;
    times.character = half_bits(2 * all);
    times.received = half_bits(2 * (kStartDataStop + parity));
    times.rest = half_bits(2 * second_stop);
    times.t35 = fixed ? 1750 : half_bits(77);
    times.turn_around = half_bits(2 * (second_stop + all));
    times.silence = fixed ? times.rest + 1750 : half_bits(2 * second_stop + 77);
    times.slack = fixed ? times.character + 750 : half_bits(2 * all + 33);
    return times;
  }
};

}  // namespace ex9000::judges
