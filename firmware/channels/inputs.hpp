// Input channels: inversion, filters, levels, latches and counters - wire.md section 5 and
// firmware/extensions.md.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/line/event_tally.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Passes edges from the edge interrupt to the main loop, as one count for each channel. Rising and falling
/// edges alternate. The main loop therefore needs only the count and the previous level to compute the number
/// of rising edges and the number of falling edges.
class InputEdges {
 public:
  /// Sets the levels at reset; bit n is channel n. These levels do not count as edges. Call this before
  /// interrupts are enabled.
  void begin(std::uint16_t levels) { levels_ = levels; }

  /// Compares `level`, the present level of `channel`, with the level at the previous call for this channel.
  /// The first call for a channel compares it with the level at reset. If the two levels differ, counts one
  /// edge. If they are the same, counts two edges. The edge interrupt calls this when the hardware has
  /// flagged an edge. Ignores the call if `channel` is kMaxInputs or greater. `now` must be the current time
  /// if `needs_times()` is true; otherwise any value is allowed.
  void on_edge(unsigned channel, bool level, Time now);

  /// Sets whether filters need the times of edges from now on. Without filters, the edge interrupt need not
  /// read the clock, so the module can process more edges in the same time. For the main loop.
  void time_edges(bool on) { needs_times_.store_in_main_loop(on); }
  [[nodiscard]] bool needs_times() const { return needs_times_.load(); }

  /// Returns the number of calls of `on_edge` that were not ignored, of all channels together; wraps.
  [[nodiscard]] std::uint32_t edges() const { return edges_.load(); }
  /// Returns the number of edges of `channel` since the last call for this channel, modulo 65536. For the
  /// main loop, which must call this at least once every 65535 edges.
  std::uint16_t collect(unsigned channel) { return channels_[channel].collect(); }
  /// Returns the time of the last edge of `channel`. Valid only if `needs_times()` was true at that edge. For
  /// the main loop.
  [[nodiscard]] Time last_edge(unsigned channel) const { return Time(last_edges_[channel].load()); }

 private:
  std::uint16_t levels_ = 0;  // after `begin`, for the interrupt only
  WrittenByInterrupt<std::uint32_t> edges_;
  std::array<EventTally, kMaxInputs> channels_;
  std::array<WrittenByInterrupt<std::uint32_t>, kMaxInputs> last_edges_;
  WrittenByMainLoop<bool> needs_times_;
};

/// Levels, latches and counters of the inputs, as the protocols read them. The level at the terminal is first
/// inverted and then filtered. Latches and counters use the edges of the filtered level. For the main loop
/// only.
///
/// Without a filter, every edge of a channel counts. With a filter, a changed level counts as one edge when
/// it has been stable for the filter time since the last edge. An edge that counts changes the level and sets
/// a latch. The counters count only rising or only falling edges.
class Inputs {
 public:
  /// The range of `counter`: five decimal digits in ASCII, 16 bits in Modbus. A counter wraps to 0.
  enum class CounterRange : std::uint8_t { FiveDigits, SixteenBits };

  /// Sets the levels at reset. `levels`: the same value as for InputEdges::begin.
  void begin(std::uint16_t levels) { levels_ = standing_ = levels; }
  /// Sets the range of all counters. Call this before a counter can reach the end of the smaller range.
  void use_range(CounterRange range) { range_ = range; }
  /// Selects whether the counters count rising or falling edges from the next `collect` on.
  void count_rising_edges(bool rising) { count_rising_edges_ = rising; }
  /// Sets the inverted channels, bit n for channel n. The levels change immediately, and this change does not
  /// count as an edge.
  void invert(std::uint16_t channels);
  /// Sets the filter times from the next `collect` on. The filter time of a channel begins at the last edge
  /// of this channel, even if that edge was before this call.
  void use_filters(const InputFilters& filters, Time now) {
    filters_ = filters;
    next_settling_.set(now);
  }

  /// Processes the first `channels` channels: counts and latches each edge of a channel without a filter, and
  /// each changed level that has been stable for its filter time at `now`. Call this at least once every
  /// 65535 edges of a channel.
  void collect(InputEdges& edges, unsigned channels, Time now);
  /// When the first of the changed levels that do not count yet will have been stable for its filter time;
  /// disarmed if there is none.
  [[nodiscard]] const Deadline& next_settling() const { return next_settling_; }

  [[nodiscard]] std::uint16_t levels() const { return levels_; }
  /// Returns the channels with a rising edge since reset or the last `clear_latches`; bit n is channel n.
  [[nodiscard]] std::uint16_t latched_high() const { return latched_high_; }
  /// Returns the channels with a falling edge since reset or the last `clear_latches`; bit n is channel n.
  [[nodiscard]] std::uint16_t latched_low() const { return latched_low_; }
  /// Returns the counter of `channel`: 0 to 99999 in ASCII, 0 to 65535 in Modbus.
  [[nodiscard]] std::uint32_t counter(unsigned channel) const { return counters_[channel]; }
  /// Returns the 32-bit counter of `channel`. It counts the same edges as `counter` and is cleared together
  /// with it.
  [[nodiscard]] std::uint32_t long_counter(unsigned channel) const { return long_counters_[channel]; }

  void clear_latches() { latched_high_ = latched_low_ = 0; }
  /// Clears `counter` and `long_counter` of each channel n whose bit n is set in `channels`.
  void clear_counters(std::uint16_t channels);

 private:
  void count(unsigned channel, std::uint32_t edges);
  [[nodiscard]] Deadline settles_at(const InputEdges& edges, unsigned channel) const;
  /// Returns the channels with a changed level that does not count yet; bit n is channel n.
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
