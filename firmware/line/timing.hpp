// The times between received frames, and the time between a request and its reply.
#pragma once

#include <cstdint>

#include "firmware/model/line_format.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// The build option EX9000_STRICT_GAPS of an image: a gap of more than T1.5 makes a Modbus frame invalid.
#ifdef EX9000_STRICT_GAPS
inline constexpr bool kStrictGaps = true;
#else
inline constexpr bool kStrictGaps = false;
#endif

struct LineTiming {
  /// Duration of a character, rounded up.
  Duration character;
  /// Shortest time between the report of CR and the reply: the rest of the stop bits of CR plus one
  /// character, rounded up.
  Duration dcon_turn_around;
  /// Time from the report of a byte to the end of the silence that ends a Modbus RTU frame and precedes a
  /// reply: the rest of the stop bits plus T3.5. It is rounded up, so that a reply is never early.
  Duration rtu_silence;
  /// Time after `rtu_silence` within which the UART reports a byte that began before the end of T3.5: the
  /// time from the beginning of a byte to its report. It is rounded down by the lateness of the silence timer
  /// too, so that a byte that begins exactly at the end of T3.5 begins a new frame.
  Duration rtu_grace;
  /// The largest time between the reports of two successive bytes of a frame; a larger time makes the frame
  /// invalid. A value of `rtu_silence` or more allows every gap.
  Duration rtu_slack;
  /// Time from the report of a byte to the end of its last stop bit, rounded up.
  Duration rest_of_stop_bit;

  /// A value for `rtu_slack` that allows every gap.
  static constexpr Duration kAnyGap{0xFFFF'FFFFU};

  /// Returns the times for a UART that reports a byte at the end of its first stop bit. Up to 19200 baud,
  /// T3.5 is 3.5 characters of 11 bits in every format. Above 19200 baud, T3.5 is 1.75 ms (Modbus over Serial
  /// Line V1.02, 2.5.1.1). Gaps within a frame are allowed, because USB adapters and gateways cause them.
  /// `baud`: 50 to 4000000 bits per second.
  static constexpr LineTiming at(std::uint32_t baud, LineFormat format) {
    const unsigned second_stop_bit = bits_of_character(format) - bits_received(format);
    const std::uint32_t until_report = microseconds(2 * bits_received(format), baud);
    LineTiming timing;
    timing.character = Duration(microseconds(2 * bits_of_character(format), baud) + 1U);
    timing.rest_of_stop_bit = Duration(second_stop_bit == 0 ? 0 : microseconds(2, baud) + 1U);
    timing.dcon_turn_around =
        timing.rest_of_stop_bit + Duration(microseconds(2 * bits_of_character(format), baud) + kRoundUp);
    timing.rtu_silence = timing.rest_of_stop_bit + Duration(silence(7, baud, 1750) + kRoundUp);
    timing.rtu_grace = Duration(until_report > kRoundDown ? until_report - kRoundDown : 1);
    timing.rtu_slack = kAnyGap;
    return timing;
  }

  /// Returns the times for a UART that reports a byte in the middle of its first stop bit. T3.5 and the
  /// allowed gaps are as in `at`. `baud` must be one of kBaudRates.
  static constexpr LineTiming reported_in_stop_bit(std::uint32_t baud, LineFormat format) {
    LineTiming timing = at(baud, format);
    const Duration half_bit(microseconds(1, baud) + 1U);
    timing.dcon_turn_around = timing.dcon_turn_around + half_bit;
    timing.rtu_silence = timing.rtu_silence + half_bit;
    timing.rest_of_stop_bit = timing.rest_of_stop_bit + half_bit;
    timing.rtu_grace = timing.rtu_grace - half_bit;  // a byte is reported half a bit earlier than in `at`
    return timing;
  }

  /// Return the same times as `at` and `reported_in_stop_bit`, except that a gap of more than T1.5 makes the
  /// frame invalid, as Modbus over Serial Line V1.02, 2.5.1.1, requires.
  static constexpr LineTiming strictly_at(std::uint32_t baud, LineFormat format) {
    return strictly(at(baud, format), baud, format);
  }
  static constexpr LineTiming strictly_reported_in_stop_bit(std::uint32_t baud, LineFormat format) {
    return strictly(reported_in_stop_bit(baud, format), baud, format);
  }

 private:
  static constexpr LineTiming strictly(LineTiming timing, std::uint32_t baud, LineFormat format) {
    timing.rtu_slack =
        Duration(silence(3, baud, 750) + microseconds(2 * bits_of_character(format), baud) + kRoundUp);
    return timing;
  }

  /// In microseconds: 1 for the rounding of the division, 1 for the resolution of the clock.
  static constexpr std::uint32_t kRoundUp = 2;
  /// In microseconds: kRoundUp, because rtu_silence is already rounded up by kRoundUp; 1 for the resolution
  /// of the clock; and twice the lateness of a timer (hal/one_shot_timer.hpp).
  static constexpr std::uint32_t kRoundDown = kRoundUp + 1 + 2 * 5;

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

/// A function that returns the times at a baud rate and format, for example `LineTiming::at`. A simulated
/// line on which bytes take almost no time uses a function that is not in LineTiming.
using TimingAt = LineTiming (*)(std::uint32_t baud, LineFormat format);

}  // namespace ex9000
