// The times by which a receiver tells frames apart and a reply keeps its distance.
#pragma once

#include <cstdint>

#include "firmware/time.hpp"

namespace ex9000 {

struct LineTiming {
  Duration dcon_turn_around;  ///< between CR and the reply: one character, 10 bits; rounded up
  Duration rtu_silence;       ///< T3.5, the silence that ends a Modbus RTU frame, and comes before a reply;
                              ///< rounded up, so a reply is never early
  Duration rtu_grace;         ///< how long behind it a byte that began before may still be coming in: one
                              ///< character; rounded up
  Duration rtu_separate;      ///< two bytes whose ends lie at least this far apart belong to two frames: T3.5
                              ///< and the second byte itself; rounded down, so a frame after exactly T3.5 is
                              ///< one of its own
  Duration rtu_slack;         ///< bytes whose ends lie further apart than this spoil a frame

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
    timing.rtu_grace = Duration(character + kRoundUp);
    timing.rtu_separate = Duration(t35 + character - 1);
    timing.rtu_slack = kAnyGap;
    return timing;
  }

  /// Likewise, for a UART that tells of a byte when it has seen the middle of its stop bit, half a bit before
  /// that is over.
  static constexpr LineTiming told_in_the_stop_bit(std::uint32_t baud) {
    LineTiming timing = at(baud);
    const Duration half_bit(microseconds(1, baud) + 1U);
    timing.dcon_turn_around = timing.dcon_turn_around + half_bit;
    timing.rtu_silence = timing.rtu_silence + half_bit;
    return timing;
  }

  /// As `at`, but a gap of more than T1.5 spoils a frame, as the same clause has it.
  static constexpr LineTiming strictly_at(std::uint32_t baud) {
    LineTiming timing = at(baud);
    timing.rtu_slack = Duration(silence(3, baud, 750) + microseconds(2 * 10, baud) + kRoundUp);
    return timing;
  }

 private:
  /// One for the division, one for a clock that shows whole microseconds.
  static constexpr std::uint32_t kRoundUp = 2;

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
