// Input channels: levels, latches and counters - wire.md section 5.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/line/crossing.hpp"
#include "firmware/model/model.hpp"

namespace ex9000 {

/// Edges as they cross from the edge interrupt to the main loop: one tally a channel and direction.
class InputEdges {
 public:
  /// Main loop, before edge interrupts come: the levels at reset, bit n for channel n, are no edges.
  void begin(std::uint16_t levels) { levels_.store_in_interrupt(levels); }

  /// Edge interrupt: an edge was flagged on `channel`, whose level is now `level`. Where the level is what it
  /// was before, there were two edges since. Channels beyond kMaxInputs are ignored.
  void on_edge(unsigned channel, bool level);

  [[nodiscard]] std::uint16_t levels() const { return levels_.load(); }
  /// Edges of all channels, modulo 256; what is the same as before may be 256 more.
  [[nodiscard]] std::uint8_t edges() const { return edges_.load(); }
  EventTally& rising(unsigned channel) { return rising_[channel]; }
  EventTally& falling(unsigned channel) { return falling_[channel]; }

 private:
  WrittenByInterrupt<std::uint16_t> levels_;
  WrittenByInterrupt<std::uint8_t> edges_;
  std::array<EventTally, kMaxInputs> rising_;
  std::array<EventTally, kMaxInputs> falling_;
};

/// What the protocols read; main loop only.
class Inputs {
 public:
  /// ASCII tells five decimal digits, Modbus 16 bits; counters wrap accordingly.
  enum class CounterRange : std::uint8_t { FiveDigits, SixteenBits };

  void configure(CounterRange range, bool count_rising_edges) {
    range_ = range;
    count_rising_edges_ = count_rising_edges;
  }

  /// Takes in what the interrupt has seen on the first `channels`; at least every 65535 edges of a channel.
  void collect(InputEdges& edges, unsigned channels);

  [[nodiscard]] std::uint16_t levels() const { return levels_; }
  /// Channels with a rising edge since reset or clearing.
  [[nodiscard]] std::uint16_t latched_high() const { return latched_high_; }
  /// Likewise with a falling one.
  [[nodiscard]] std::uint16_t latched_low() const { return latched_low_; }
  /// 0 to 99999 or 65535.
  [[nodiscard]] std::uint32_t counter(unsigned channel) const { return counters_[channel]; }

  void clear_latches() { latched_high_ = latched_low_ = 0; }
  /// Bit n of `channels` clears counter n.
  void clear_counters(std::uint16_t channels);

 private:
  CounterRange range_ = CounterRange::FiveDigits;
  bool count_rising_edges_ = false;
  std::uint16_t levels_ = 0;
  std::uint16_t latched_high_ = 0;
  std::uint16_t latched_low_ = 0;
  std::array<std::uint32_t, kMaxInputs> counters_{};
};

}  // namespace ex9000
