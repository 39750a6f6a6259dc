// A UART receiver that samples the levels on the wires. Wires uses it for a station that cannot get a byte
// unchanged, for example because the sender has another rate.
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

/// The levels of a byte on the wires, from bit 0 on: start bit, 8 data bits with the lowest first, parity bit
/// if the format has one, first stop bit. A second stop bit is idle time for all receivers.
using Levels = std::uint16_t;
constexpr Levels kIdleLevels = 0x7FF;

/// Returns the format as receivers read it: they ignore a second stop bit.
constexpr LineFormat as_received(LineFormat format) {
  return format == LineFormat::k8N2 ? LineFormat::k8N1 : format;
}

/// Returns whether stations in these modes get each other's bytes unchanged.
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

/// The mask of the parity bit in Levels, if the format has a parity bit.
constexpr unsigned kParityBit = 1U << 9U;

/// Returns the mask of the first stop bit in Levels.
constexpr unsigned stop_bit(LineFormat format) { return 1U << (bits_received(format) - 1U); }

constexpr Levels levels_of(std::uint8_t byte, LineFormat format = LineFormat::k8N1) {
  const bool parity = has_parity(format) && has_odd_number_of_ones(byte) == (format == LineFormat::k8E1);
  return static_cast<Levels>(stop_bit(format) | (parity ? kParityBit : 0U) | unsigned{byte} << 1U);
}

/// Returns `levels` with the parity bit inverted. Levels without a parity bit stay the same.
constexpr Levels with_wrong_parity(Levels levels, LineFormat format) {
  return static_cast<Levels>(has_parity(format) ? levels ^ kParityBit : levels);
}

/// Returns the data bits in `levels`.
constexpr std::uint8_t byte_of(Levels levels) { return static_cast<std::uint8_t>(levels >> 1U); }

/// Returns what a UART reports for a character that has a start bit: Break if all bits are 0, FramingError if
/// the first stop bit is missing, ParityError if the parity is wrong, otherwise Good.
constexpr ByteStatus status_of(Levels levels, LineFormat format) {
  if ((levels & stop_bit(format)) == 0) {
    return levels == 0 ? ByteStatus::Break : ByteStatus::FramingError;
  }
  const bool right = !has_parity(format) || levels == levels_of(byte_of(levels), format);
  return right ? ByteStatus::Good : ByteStatus::ParityError;
}

/// A byte that a station sends: its value, its times, and its levels on the wires, which a disturbance may
/// have changed.
struct Wave {
  /// `its_mode`: the bit rate on the wires, not 0, and the format as receivers read it.
  Wave(VirtualTime its_start, SerialMode its_mode, Levels its_levels)
      : start(its_start), mode(its_mode), levels(its_levels), end(boundary(bits())) {}

  [[nodiscard]] unsigned bits() const { return bits_received(mode.format); }
  /// Returns the time at which bit `index` begins, or the end of the first stop bit if `index` is `bits()`.
  [[nodiscard]] VirtualTime boundary(unsigned index) const;
  /// Returns the level at the time `at`. true: the idle level, which is also the level of a 1. The level is
  /// idle before the byte, after its first stop bit, and from `cut_off` on.
  [[nodiscard]] bool level(VirtualTime at) const;

  VirtualTime start;
  SerialMode mode;
  Levels levels;
  VirtualTime end;  ///< the end of the first stop bit
  /// Time at which the driver was disabled during the byte; kNever: the driver was not disabled.
  VirtualTime cut_off = hal::doubles::kNever;
  std::size_t station = 0;
  SerialMode nominal;  ///< the nominal rate and the format in which the station sends
  std::uint8_t byte = 0;
  bool disturbed = false;  ///< the levels differ from those of `byte`
  /// At least two drivers were enabled, another byte was on the wires, or the byte was cut off.
  bool collided = false;
  bool over = false;  ///< the byte has ended; samplers may still read it

  /// Returns whether the byte arrives unchanged at a receiver that has the same mode and has listened since
  /// the start of the byte.
  [[nodiscard]] bool arrives_whole() const { return !collided && !disturbed; }
};

using Waves = std::vector<Wave>;

/// Samples characters: waits for the level 0, then reads the middle of each bit.
class UartSampler {
 public:
  struct Received {
    std::uint8_t byte;
    ByteStatus status;
  };

  /// Samples the wires up to `until`, or up to the end of the next byte. Returns this byte if its first stop
  /// bit ends at `until` or earlier, otherwise nullopt. If the result is a byte, the caller must call this
  /// function again with the same `until`. `mode` has the bit rate on the wires, and must be the same in all
  /// calls.
  std::optional<Received> advance(const Waves& waves, SerialMode mode, VirtualTime until);

  /// Returns whether the sampler is in the middle of a byte or waits for the line to become idle.
  [[nodiscard]] bool busy() const { return receiving_ || waits_for_idle_ || complete_; }
  /// Returns when `advance` must be called again after a call with `now`: at the end of a byte whose first
  /// stop bit has been sampled, otherwise half a bit after `now`.
  [[nodiscard]] VirtualTime next(SerialMode mode, VirtualTime now) const;
  /// Returns the time up to which the sampler has processed the wires.
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
