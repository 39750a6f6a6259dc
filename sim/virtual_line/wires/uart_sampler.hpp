// A UART that samples the wires, for a station that cannot get a byte whole, for example at another rate.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/line/verdict.hpp"
#include "firmware/model/line_format.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::sim {

using hal::SerialMode;
using hal::doubles::VirtualTime;

/// From bit 0: start bit, 8 data bits (lowest first), parity if any, first stop bit. A second one is idle.
using Levels = std::uint16_t;
constexpr Levels kIdleLevels = 0x7FF;

/// As receivers read it: they ignore a second stop bit.
constexpr LineFormat as_received(LineFormat format) {
  return format == LineFormat::k8N2 ? LineFormat::k8N1 : format;
}

constexpr bool hear_each_other(SerialMode a, SerialMode b) {
  return a.baud == b.baud && as_received(a.format) == as_received(b.format);
}

constexpr bool has_odd_number_of_ones(std::uint8_t byte) {
  bool odd = false;
  for (unsigned rest = byte; rest != 0; rest &= rest - 1U) {
    odd = !odd;
  }
  return odd;
}

/// Masks in Levels; not every format has parity.
constexpr unsigned kParityBit = 1U << 9U;

constexpr unsigned stop_bit(LineFormat format) { return 1U << (bits_received(format) - 1U); }

constexpr Levels levels_of(std::uint8_t byte, LineFormat format = LineFormat::k8N1) {
  const bool parity = has_parity(format) && has_odd_number_of_ones(byte) == (format == LineFormat::k8E1);
  return static_cast<Levels>(stop_bit(format) | (parity ? kParityBit : 0U) | unsigned{byte} << 1U);
}

/// No effect without a parity bit.
constexpr Levels with_wrong_parity(Levels levels, LineFormat format) {
  return static_cast<Levels>(has_parity(format) ? levels ^ kParityBit : levels);
}

constexpr std::uint8_t byte_of(Levels levels) { return static_cast<std::uint8_t>(levels >> 1U); }

/// What a UART reports for a character that has a start bit.
constexpr ByteStatus status_of(Levels levels, LineFormat format) {
  if ((levels & stop_bit(format)) == 0) {
    return levels == 0 ? ByteStatus::Break : ByteStatus::FramingError;
  }
  const bool right = !has_parity(format) || levels == levels_of(byte_of(levels), format);
  return right ? ByteStatus::Good : ByteStatus::ParityError;
}

/// A byte on the wires. A disturbance may have changed its levels.
struct Wave {
  /// `its_mode`: the bit rate on the wires, not 0, and the format as receivers read it.
  Wave(VirtualTime its_start, SerialMode its_mode, Levels its_levels)
      : start(its_start), mode(its_mode), levels(its_levels), end(boundary(bits())) {}

  [[nodiscard]] unsigned bits() const { return bits_received(mode.format); }
  /// When the bit begins; for `bits()`, the end of the first stop bit.
  [[nodiscard]] VirtualTime boundary(unsigned index) const;
  /// true: 1 or idle. Idle before the byte, after its first stop bit, and from `cut_off` on.
  [[nodiscard]] bool level(VirtualTime at) const;

  VirtualTime start;
  SerialMode mode;
  Levels levels;
  VirtualTime end;  ///< the end of the first stop bit
  /// When the driver was disabled during the byte; kNever: it was not.
  VirtualTime cut_off = hal::doubles::kNever;
  std::size_t station = 0;
  std::vector<std::size_t> also;  ///< other stations that send the same at the same time
  SerialMode nominal;             ///< the nominal rate and the format in which the station sends
  std::uint8_t byte = 0;
  bool disturbed = false;  ///< the levels differ from those of `byte`
  /// Another driver or byte was there too, or the byte was cut off.
  bool collided = false;
  bool over = false;  ///< the byte has ended; samplers may still read it

  /// At a receiver in the same mode that has listened since the byte's start.
  [[nodiscard]] bool arrives_whole() const { return !collided && !disturbed; }
};

using Waves = std::vector<Wave>;

/// Waits for the level 0, then samples the middle of each bit.
class UartSampler {
 public:
  struct Received {
    std::uint8_t byte;
    ByteStatus status;
  };

  /// Samples up to `until`, or to the end of the next byte, which it returns if its first stop bit is over by
  /// then; after a byte, call it again with the same `until`. `mode`: on the wires, the same in all calls.
  std::optional<Received> advance(const Waves& waves, SerialMode mode, VirtualTime until);

  /// In the middle of a byte, or waiting for the line to become idle.
  [[nodiscard]] bool busy() const { return receiving_ || waits_for_idle_ || complete_; }
  /// The next call of `advance`: at the end of a byte whose stop bit is sampled, else in half a bit.
  [[nodiscard]] VirtualTime next(SerialMode mode, VirtualTime now) const;
  /// The wires are processed up to here.
  [[nodiscard]] VirtualTime position() const { return position_; }
  void skip_to(VirtualTime position) { position_ = position; }

 private:
  bool receiving_ = false;
  bool waits_for_idle_ = false;
  unsigned bit_ = 0;
  Levels levels_ = 0;  ///< the bits that have been sampled so far
  VirtualTime start_{0};
  VirtualTime position_{0};
  std::optional<Received> complete_;  ///< a byte whose first stop bit has been sampled but is not over
};

}  // namespace ex9000::sim
