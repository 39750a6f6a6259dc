// The times by which a receiver tells frames apart and a reply keeps its distance.
#pragma once

#include <cstdint>

#include "firmware/time.hpp"

namespace ex9000 {

struct LineTiming {
  /// Between CR and the reply: one character, 10 bits; rounded up.
  Duration dcon_turn_around;
  /// T3.5, the silence that ends a Modbus RTU frame, and that comes before a reply; rounded up, so that a
  /// reply is never early.
  Duration rtu_silence;
  /// After `rtu_silence`, how long a byte that began before T3.5 may take until it is complete: one
  /// character; rounded down, so that a frame after exactly T3.5 is one of its own.
  Duration rtu_grace;
  /// Bytes whose ends lie further apart than this spoil a frame.
  Duration rtu_slack;

  /// For rtu_slack: no gap spoils a frame.
  static constexpr Duration kAnyGap{0xFFFF'FFFFU};

  /// Modbus over Serial Line V1.02, 2.5.1.1: T3.5 counts 11-bit characters up to 19200 baud and is fixed
  /// above. Gaps inside a frame are tolerated, since USB adapters and gateways make them. `baud` in bits per
  /// second, 50 to 4000000.
  static constexpr LineTiming at(std::uint32_t baud) {
    const std::uint32_t character = microseconds(2 * 10, baud);
    const std::uint32_t t35 = silence(7, baud, 1750);
    LineTiming timing;
    timing.dcon_turn_around = Duration(character + kRoundUp);
    timing.rtu_silence = Duration(t35 + kRoundUp);
    timing.rtu_grace = Duration(character > kRoundDown ? character - kRoundDown : 1);
    timing.rtu_slack = kAnyGap;
    return timing;
  }

  /// Likewise, for standard rates and a UART that tells of a byte when it has seen the middle of its stop
  /// bit, half a bit before that is over.
  static constexpr LineTiming told_in_the_stop_bit(std::uint32_t baud) {
    LineTiming timing = at(baud);
    const Duration half_bit(microseconds(1, baud) + 1U);
    timing.dcon_turn_around = timing.dcon_turn_around + half_bit;
    timing.rtu_silence = timing.rtu_silence + half_bit;
    timing.rtu_grace = timing.rtu_grace - half_bit;  // the byte is told as early
    return timing;
  }

  /// As `at`, but a gap of more than T1.5 spoils a frame, as the same clause has it.
  static constexpr LineTiming strictly_at(std::uint32_t baud) { return strictly(at(baud), baud); }
  static constexpr LineTiming strictly_told_in_the_stop_bit(std::uint32_t baud) {
    return strictly(told_in_the_stop_bit(baud), baud);
  }

 private:
  static constexpr LineTiming strictly(LineTiming timing, std::uint32_t baud) {
    timing.rtu_slack = Duration(silence(3, baud, 750) + microseconds(2 * 10, baud) + kRoundUp);
    return timing;
  }

  /// One for the division, one for a clock that shows whole microseconds.
  static constexpr std::uint32_t kRoundUp = 2;
  /// What rtu_silence was rounded up by, and one.
  static constexpr std::uint32_t kRoundDown = kRoundUp + 1;

  static constexpr std::uint32_t microseconds(std::uint32_t half_bits, std::uint32_t baud) {
    constexpr std::uint32_t kHalfSecond = 500'000;
    return half_bits * kHalfSecond / baud;
  }
  static constexpr std::uint32_t silence(std::uint32_t half_characters, std::uint32_t baud,
                                         std::uint32_t fixed) {
    constexpr std::uint32_t kFixedTimesAbove = 19200;
    return baud > kFixedTimesAbove ? fixed : microseconds(half_characters * 11, baud);
  }
};

/// What times hold at which rate: `LineTiming::at` on two wires. Other carriers, where bytes cost no time,
/// have their own.
using TimingAt = LineTiming (*)(std::uint32_t baud);

}  // namespace ex9000
