#include "firmware/channels/inputs.hpp"

#include "firmware/expect.hpp"

namespace ex9000 {

void InputEdges::on_edge(unsigned channel, bool level, Time now) {
  if (channel >= kMaxInputs) {
    return;
  }
  const std::uint32_t bit = 1U << channel;
  if (level == ((levels_ & bit) != 0)) {
    channels_[channel].count_in_interrupt(2);
  } else {
    channels_[channel].count_in_interrupt(1);
    levels_ = static_cast<std::uint16_t>(levels_ ^ bit);
  }
  last_edges_[channel].store_in_interrupt(now.microseconds());
  edges_.store_in_interrupt(edges_.load() + 1U);
}

void Inputs::invert(std::uint16_t channels) {
  const auto changed = static_cast<std::uint16_t>(channels ^ inverted_);
  inverted_ = channels;
  standing_ = static_cast<std::uint16_t>(standing_ ^ changed);
  levels_ = static_cast<std::uint16_t>(levels_ ^ changed);
}

void Inputs::collect(InputEdges& edges, unsigned channels, Time now) {
  const std::uint32_t all = edges.edges();
  if (all == edges_seen_ && !next_settling_.reached(now)) {
    return;
  }
  edges_seen_ = all;
  next_settling_.disarm();
  for (unsigned channel = 0; channel < channels; ++channel) {
    const std::uint32_t bit = 1U << channel;
    const std::uint32_t fresh = edges.collect(channel);
    const bool filtered = filters_.of(channel) != 0;
    if (!filtered && (settling() & bit) != 0) {
      count(channel, 1);  // the filter was switched off while the level was settling
    }
    standing_ = static_cast<std::uint16_t>(standing_ ^ ((fresh & 1U) << channel));
    if (!filtered) {
      count(channel, fresh);
    } else if ((settling() & bit) != 0) {
      const Deadline settles = settles_at(edges, channel);
      if (settles.reached(now)) {
        count(channel, 1);
      } else {
        next_settling_.advance_to(settles);
      }
    }
  }
}

/// Counts and latches `edges` alternating edges, and updates the level.
void Inputs::count(unsigned channel, std::uint32_t edges) {
  if (edges == 0) {
    return;
  }
  const std::uint32_t modulus = range_ == CounterRange::FiveDigits ? 100'000U : 65'536U;
  EX9000_EXPECT(counters_[channel] < modulus);
  const std::uint32_t bit = 1U << channel;
  const std::uint32_t was_high = levels_ >> channel & 1U;
  const std::uint32_t rising = (edges + 1U - was_high) / 2U;  // the first edge rises if the level was low
  const std::uint32_t falling = edges - rising;
  latched_high_ = static_cast<std::uint16_t>(latched_high_ | (rising != 0 ? bit : 0U));
  latched_low_ = static_cast<std::uint16_t>(latched_low_ | (falling != 0 ? bit : 0U));
  levels_ = static_cast<std::uint16_t>(levels_ ^ (rising != falling ? bit : 0U));
  const std::uint32_t counted = count_rising_edges_ ? rising : falling;
  const std::uint32_t sum = counters_[channel] + counted;
  counters_[channel] = sum < modulus ? sum : sum - modulus;
  long_counters_[channel] += counted;
}

/// When the changed level counts. Only while the channel is settling.
Deadline Inputs::settles_at(const InputEdges& edges, unsigned channel) const {
  constexpr Duration kRoundUp(1);  // the edge may have happened up to 1 us later than its recorded time
  return Deadline(edges.last_edge(channel) + milliseconds(filters_.of(channel)) + kRoundUp);
}

void Inputs::clear_counters(std::uint16_t channels) {
  for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
    if ((channels & (1U << channel)) != 0) {
      counters_[channel] = 0;
      long_counters_[channel] = 0;
    }
  }
}

}  // namespace ex9000
