// Input channels: levels, latches and counters - wire.md section 5.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/line/crossing.hpp"
#include "firmware/line/event_tally.hpp"
#include "firmware/model/model.hpp"

namespace ex9000 {

/// Edges as they cross from the edge interrupt to the main loop: one count a channel. Rising and falling ones
/// take turns, so the count and the level before tell how many there were of each.
class InputEdges {
 public:
  /// Main loop, before edge interrupts come: the levels at reset, bit n for channel n, are no edges.
  void begin(std::uint16_t levels) { levels_ = levels; }

  /// Edge interrupt: an edge was flagged on `channel`, whose level is now `level`. Where the level is what it
  /// was before, there were two edges since. Channels beyond kMaxInputs are ignored.
  void on_edge(unsigned channel, bool level);

  /// Edges of all channels.
  [[nodiscard]] std::uint32_t edges() const { return edges_.load(); }
  /// Main loop: those of one channel since it was last asked; at least every 65535 of them.
  std::uint16_t collect(unsigned channel) { return channels_[channel].collect(); }

 private:
  std::uint16_t levels_ = 0;  // interrupt
  WrittenByInterrupt<std::uint32_t> edges_;
  std::array<EventTally, kMaxInputs> channels_;
};

/// What the protocols read; main loop only.
class Inputs {
 public:
  /// ASCII tells five decimal digits, Modbus 16 bits; counters wrap accordingly.
  enum class CounterRange : std::uint8_t { FiveDigits, SixteenBits };

  /// `levels` as given to InputEdges::begin.
  void begin(std::uint16_t levels) { levels_ = levels; }
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
  std::uint32_t edges_seen_ = 0;  ///< of all channels
  CounterRange range_ = CounterRange::FiveDigits;
  bool count_rising_edges_ = false;
  std::uint16_t levels_ = 0;
  std::uint16_t latched_high_ = 0;
  std::uint16_t latched_low_ = 0;
  std::array<std::uint32_t, kMaxInputs> counters_{};
};

}  // namespace ex9000
