#include "firmware/channels/inputs.hpp"

namespace ex9000 {

void InputEdges::on_edge(unsigned channel, bool level) {
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
  edges_.store_in_interrupt(edges_.load() + 1U);
}

void Inputs::collect(InputEdges& edges, unsigned channels) {
  const std::uint32_t all = edges.edges();
  if (all == edges_seen_) {
    return;
  }
  edges_seen_ = all;
  const std::uint32_t modulus = range_ == CounterRange::FiveDigits ? 100'000U : 65'536U;
  for (unsigned channel = 0; channel < channels; ++channel) {
    const std::uint32_t fresh = edges.collect(channel);
    if (fresh == 0) {
      continue;
    }
    const std::uint32_t bit = 1U << channel;
    const std::uint32_t was_high = levels_ >> channel & 1U;
    const std::uint32_t rising = (fresh + 1U - was_high) / 2U;  // the first edge rises if the level was low
    const std::uint32_t falling = fresh - rising;
    latched_high_ = static_cast<std::uint16_t>(latched_high_ | (rising != 0 ? bit : 0U));
    latched_low_ = static_cast<std::uint16_t>(latched_low_ | (falling != 0 ? bit : 0U));
    levels_ = static_cast<std::uint16_t>(levels_ ^ (rising != falling ? bit : 0U));
    const std::uint32_t count = counters_[channel] + (count_rising_edges_ ? rising : falling);
    counters_[channel] = count < modulus ? count : count - modulus;
  }
}

void Inputs::clear_counters(std::uint16_t channels) {
  for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
    if ((channels & (1U << channel)) != 0) {
      counters_[channel] = 0;
    }
  }
}

}  // namespace ex9000
