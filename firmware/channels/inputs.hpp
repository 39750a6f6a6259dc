// Inputs: inversion, filters, levels, latches and counters - wire.md section 5, firmware/extensions.md.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/line/event_tally.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Passes edges from the edge interrupt to the main loop, as one count per channel. Edges alternate, so the
/// count and the previous level give the rising and the falling ones.
class InputEdges {
 public:
  /// The levels at reset, bit n for channel n; not counted as edges. Before interrupts are enabled.
  void begin(std::uint16_t levels) { levels_ = levels; }

  /// The edge interrupt calls this when the hardware has flagged an edge. `level` is the present level: one
  /// edge if it differs from that at the channel's previous call (at first, at reset), else two. A `channel`
  /// from kMaxInputs on is ignored. `now`: the current time if `needs_times()`, else any.
  void on_edge(unsigned channel, bool level, Time now);

  /// For the main loop: whether filters need the times of edges. Without filters, the interrupt need not read
  /// the clock and keeps up with more edges.
  void time_edges(bool on) { needs_times_.store_in_main_loop(on); }
  [[nodiscard]] bool needs_times() const { return needs_times_.load(); }

  /// Calls of `on_edge` that were not ignored, all channels together; wraps.
  [[nodiscard]] std::uint32_t edges() const { return edges_.load(); }
  /// For the main loop, at least every 65535 edges: those since the channel's last call, modulo 65536.
  std::uint16_t collect(unsigned channel) { return channels_[channel].collect(); }
  /// For the main loop: time of the last edge. Valid only if `needs_times()` was true then.
  [[nodiscard]] Time last_edge(unsigned channel) const { return Time(last_edges_[channel].load()); }

 private:
  std::uint16_t levels_ = 0;  // after `begin`, for the interrupt only
  WrittenByInterrupt<std::uint32_t> edges_;
  std::array<EventTally, kMaxInputs> channels_;
  std::array<WrittenByInterrupt<std::uint32_t>, kMaxInputs> last_edges_;
  WrittenByMainLoop<bool> needs_times_;
};

/// The inputs as the protocols read them. The terminal's level is inverted, then filtered; latches and
/// counters use the edges of the filtered level. In masks, bit n is channel n. For the main loop only.
///
/// Without a filter, every edge counts. With one, a changed level counts as one edge once it has been stable
/// for the filter time since the last edge. An edge that counts changes the level and sets a latch. The
/// counters count only rising or only falling edges.
class Inputs {
 public:
  /// `counter` wraps to 0 after 99999 (ASCII: five digits) or 65535 (Modbus).
  enum class CounterRange : std::uint8_t { FiveDigits, SixteenBits };

  /// `levels`: as for InputEdges::begin.
  void begin(std::uint16_t levels) { levels_ = standing_ = levels; }
  /// For all counters. Before one can reach the end of the smaller range.
  void use_range(CounterRange range) { range_ = range; }
  /// Rising, else falling edges, from the next `collect` on.
  void count_rising_edges(bool rising) { count_rising_edges_ = rising; }
  /// The levels change at once, without an edge.
  void invert(std::uint16_t channels);
  /// From the next `collect` on. Filter times begin at the channel's last edge, even one before this call.
  void use_filters(const InputFilters& filters, Time now) {
    filters_ = filters;
    next_settling_.set(now);
  }

  /// For the first `channels` channels. Call it at least once every 65535 edges of a channel.
  void collect(InputEdges& edges, unsigned channels, Time now);
  /// When the first changed level that does not count yet will have been stable; disarmed if there is none.
  [[nodiscard]] const Deadline& next_settling() const { return next_settling_; }

  [[nodiscard]] std::uint16_t levels() const { return levels_; }
  /// Rising edges (below: falling ones) since reset or the last `clear_latches`.
  [[nodiscard]] std::uint16_t latched_high() const { return latched_high_; }
  [[nodiscard]] std::uint16_t latched_low() const { return latched_low_; }
  [[nodiscard]] std::uint32_t counter(unsigned channel) const { return counters_[channel]; }
  /// 32 bits; counts and is cleared with `counter`.
  [[nodiscard]] std::uint32_t long_counter(unsigned channel) const { return long_counters_[channel]; }

  void clear_latches() { latched_high_ = latched_low_ = 0; }
  void clear_counters(std::uint16_t channels);

 private:
  void count(unsigned channel, std::uint32_t edges);
  [[nodiscard]] Deadline settles_at(const InputEdges& edges, unsigned channel) const;
  /// The channels with a changed level that does not count yet.
  [[nodiscard]] std::uint16_t settling() const { return static_cast<std::uint16_t>(levels_ ^ standing_); }

  std::uint32_t edges_seen_ = 0;  ///< InputEdges::edges at the last `collect`
  Deadline next_settling_;
  CounterRange range_ = CounterRange::FiveDigits;
  bool count_rising_edges_ = false;
  InputFilters filters_;
  std::uint16_t inverted_ = 0;
  std::uint16_t standing_ = 0;  ///< the levels after inversion, before the filter
  std::uint16_t levels_ = 0;    ///< the levels after the filter
  std::uint16_t latched_high_ = 0;
  std::uint16_t latched_low_ = 0;
  std::array<std::uint32_t, kMaxInputs> counters_{};
  std::array<std::uint32_t, kMaxInputs> long_counters_{};
};

}  // namespace ex9000
