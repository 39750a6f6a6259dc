// The receiver of a UART that samples the wave on the wires. The bus uses it if the receiver cannot get a
// byte unchanged, for example because the sender has another rate.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/line/verdict.hpp"
#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::VirtualTime;

/// The levels of a byte on the wires, from bit 0 on: start bit, 8 data bits with the lowest first, stop bit.
using Levels = std::uint16_t;
constexpr Levels kIdleLevels = 0x3FF;
constexpr Levels levels_of(std::uint8_t byte) { return static_cast<Levels>(0x200U | unsigned{byte} << 1U); }

/// The levels of a byte as one driver puts them on the wires, and the byte that its station has sent.
struct Wave {
  /// `its_baud`: the bit rate, not 0.
  Wave(VirtualTime its_start, std::uint32_t its_baud, Levels its_levels)
      : start(its_start), baud(its_baud), levels(its_levels), ends(boundary(kBits)) {}

  static constexpr unsigned kBits = 10;

  /// Returns the time at which bit `index` begins; for kBits, the end of the byte.
  [[nodiscard]] VirtualTime boundary(unsigned index) const;
  [[nodiscard]] VirtualTime end() const { return ends; }
  /// Returns true for the idle level. Outside the byte the level is idle too.
  [[nodiscard]] bool level(VirtualTime at) const;

  VirtualTime start;
  std::uint32_t baud;
  Levels levels;
  VirtualTime ends;
  VirtualTime cut_off = hal::doubles::kNever;  ///< time at which the driver was disabled
  std::size_t station = 0;
  std::uint32_t nominal_baud = 0;  ///< the rate that the station is set to
  std::uint8_t byte = 0;
  bool collided = false;  ///< another driver was enabled, or another byte was on the wires
  bool over = false;      ///< has ended; samplers may still read it

  /// Returns whether a receiver with the same rate gets the byte unchanged.
  [[nodiscard]] bool arrives_whole() const { return !collided && levels == levels_of(byte); }
};

using Waves = std::vector<Wave>;

/// Samples 8N1 characters: waits for a falling edge, then reads the middle of each bit.
class UartSampler {
 public:
  struct Received {
    std::uint8_t byte;
    ByteStatus status;
  };

  /// Samples the wires up to `until`. Returns a byte when its stop bit is over; call again then.
  std::optional<Received> advance(const Waves& waves, std::uint32_t baud, VirtualTime until);

  /// Returns whether the sampler is in the middle of a byte or waits for the line to become idle.
  [[nodiscard]] bool busy() const { return receiving_ || waits_for_idle_ || complete_; }
  /// Returns when `advance` must be called again after a call with `now`: at the end of the byte, or after
  /// half a bit.
  [[nodiscard]] VirtualTime next(std::uint32_t baud, VirtualTime now) const;
  /// Returns the time up to which the sampler has processed the wires.
  [[nodiscard]] VirtualTime position() const { return position_; }
  void skip_to(VirtualTime position) { position_ = position; }

 private:
  bool receiving_ = false;
  bool waits_for_idle_ = false;
  unsigned bit_ = 0;
  std::uint8_t byte_ = 0;
  VirtualTime start_{0};
  VirtualTime position_{0};
  std::optional<Received> complete_;  ///< a byte whose stop bit has been sampled, but is not over
};

}  // namespace ex9000::sim
