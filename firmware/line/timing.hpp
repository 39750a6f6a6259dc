// The times between frames, and between a request and its reply.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/model/line_format.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Build option of an image: a gap of more than T1.5 makes a Modbus frame invalid.
#ifdef EX9000_STRICT_GAPS
inline constexpr bool kStrictGaps = true;
#else
inline constexpr bool kStrictGaps = false;
#endif

/// What a reply may take beyond its bytes, for gaps that late interrupts cause.
constexpr Duration kReplyMargin = milliseconds(100);

struct LineTiming {
  /// Its duration, rounded up.
  Duration character;
  /// Least time from the report of CR to the reply: the rest of its stop bits and a character, rounded up.
  Duration dcon_turn_around;
  /// From the report of a byte to the end of the silence that ends an RTU frame and precedes a reply: the
  /// rest of the stop bits plus T3.5, rounded up so that a reply is never early.
  Duration rtu_silence;
  /// From the beginning of a byte to its report: within this time after `rtu_silence`, the UART reports a
  /// byte that began during T3.5. Rounded down, also by the lateness of the silence timer, so that a byte
  /// that begins exactly at the end of T3.5 begins a new frame.
  Duration rtu_grace;
  /// The largest time between the reports of two bytes of a frame; a longer one makes the frame invalid. From
  /// `rtu_silence` on: every gap is allowed.
  Duration rtu_slack;
  /// From the report of a byte to the end of its last stop bit, rounded up.
  Duration rest_of_stop_bit;
  /// From the report of the last byte of a request to the first window of its arbitration: the rest of the
  /// stop bits, then 3.5 characters of 12 bits, at least 800 us rounded up to whole bits (extensions.md,
  /// scan).
  Duration arbitration;
  /// Of a window of an arbitration, in 1/64 us: 12 bits and 50 us rounded up to whole bits.
  std::uint32_t window_64ths = 0;

  [[nodiscard]] constexpr Duration windows(unsigned count) const {
    return Duration(count * window_64ths / kParts);
  }

  static constexpr Duration kAnyGap{0xFFFF'FFFFU};

  /// For a UART that reports a byte at the end of its first stop bit. T3.5: 3.5 characters of 11 bits in
  /// every format up to 19200 baud, 1.75 ms above (Modbus over Serial Line V1.02, 2.5.1.1). Gaps are allowed,
  /// because USB adapters and gateways cause them. `baud`: 50 to 4000000 bits per second.
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
    const std::uint32_t before = std::max<std::uint32_t>(42, whole_bits(800, baud));
    timing.arbitration = timing.rest_of_stop_bit + Duration(microseconds(2 * before, baud) + 1U);
    const std::uint32_t window = 12 + whole_bits(50, baud);
    timing.window_64ths =
        window * kMicroseconds / baud * kParts + window * kMicroseconds % baud * kParts / baud;
    return timing;
  }

  /// As `at`, but the UART reports a byte in the middle of its first stop bit. `baud`: one of kBaudRates.
  static constexpr LineTiming reported_in_stop_bit(std::uint32_t baud, LineFormat format) {
    LineTiming timing = at(baud, format);
    const Duration half_bit(microseconds(1, baud) + 1U);
    timing.dcon_turn_around = timing.dcon_turn_around + half_bit;
    timing.rtu_silence = timing.rtu_silence + half_bit;
    timing.rest_of_stop_bit = timing.rest_of_stop_bit + half_bit;
    timing.arbitration = timing.arbitration + half_bit;
    timing.rtu_grace = timing.rtu_grace - half_bit;  // a byte is reported half a bit earlier than in `at`
    return timing;
  }

  /// As above, but a gap of more than T1.5 makes the frame invalid (Modbus over Serial Line V1.02, 2.5.1.1).
  static constexpr LineTiming strictly_at(std::uint32_t baud, LineFormat format) {
    return strictly(at(baud, format), baud, format);
  }
  static constexpr LineTiming strictly_reported_in_stop_bit(std::uint32_t baud, LineFormat format) {
    return strictly(reported_in_stop_bit(baud, format), baud, format);
  }

 private:
  static constexpr std::uint32_t kMicroseconds = 1'000'000;
  static constexpr std::uint32_t kParts = 64;

  static constexpr std::uint32_t whole_bits(std::uint32_t microseconds, std::uint32_t baud) {
    return (microseconds * baud + (kMicroseconds - 1)) / kMicroseconds;
  }

  static constexpr LineTiming strictly(LineTiming timing, std::uint32_t baud, LineFormat format) {
    timing.rtu_slack =
        Duration(silence(3, baud, 750) + microseconds(2 * bits_of_character(format), baud) + kRoundUp);
    return timing;
  }

  /// In microseconds: 1 for the division, 1 for the resolution of the clock.
  static constexpr std::uint32_t kRoundUp = 2;
  /// In microseconds: kRoundUp, which rtu_silence includes; 1 for the resolution of the clock; twice the
  /// lateness of a timer (hal/one_shot_timer.hpp).
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

/// For example `LineTiming::at`. A simulated line whose bytes take almost no time has its own function.
using TimingAt = LineTiming (*)(std::uint32_t baud, LineFormat format);

}  // namespace ex9000
