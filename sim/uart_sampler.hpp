// A UART's receiver that samples the wave on the wires, for when the wave is not what it expects.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "firmware/line/verdict.hpp"
#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::VirtualTime;

/// What the wires show of a byte, bit by bit from bit 0 on: start bit, 8 data bits low first, stop bit.
using Levels = std::uint16_t;
constexpr Levels kIdleLevels = 0x3FF;
constexpr Levels levels_of(std::uint8_t byte) { return static_cast<Levels>(0x200U | unsigned{byte} << 1U); }

/// That, as one driver puts it on the wires.
struct Wave {
  VirtualTime start{0};
  std::uint32_t baud = 0;
  Levels levels = kIdleLevels;
  VirtualTime cut_off = hal::doubles::kNever;  ///< the driver went off here

  static constexpr unsigned kBits = 10;

  /// Where bit `index` begins; kBits: where the byte is over.
  [[nodiscard]] VirtualTime boundary(unsigned index) const;
  [[nodiscard]] VirtualTime end() const { return boundary(kBits); }
  /// 1 is the idle level, also outside the byte.
  [[nodiscard]] bool level(VirtualTime at) const;
};

using Waves = std::deque<Wave>;

/// 8N1: waits for a falling edge, looks at the middle of each bit.
class UartSampler {
 public:
  struct Received {
    std::uint8_t byte;
    ByteStatus status;
  };

  /// Looks at the wires up to `until`, or to the end of the first byte if that comes before.
  std::optional<Received> advance(const Waves& waves, std::uint32_t baud, VirtualTime until);

  /// In the middle of a byte, or waiting for the line to become idle.
  [[nodiscard]] bool busy() const { return receiving_ || wants_idle_; }
  /// What came before is known.
  [[nodiscard]] VirtualTime position() const { return position_; }
  void skip_to(VirtualTime position) { position_ = position; }

 private:
  bool receiving_ = false;
  bool wants_idle_ = false;
  unsigned bit_ = 0;
  std::uint8_t byte_ = 0;
  VirtualTime start_{0};
  VirtualTime position_{0};
};

}  // namespace ex9000::sim
