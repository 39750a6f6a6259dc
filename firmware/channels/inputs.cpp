#include "firmware/channels/inputs.hpp"

namespace ex9000 {

void InputEdges::on_edge(unsigned channel, bool level) {
  if (channel >= kMaxInputs) {
    return;
  }
  const std::uint16_t levels = levels_.load();
  const auto bit = static_cast<std::uint16_t>(1U << channel);
  const bool was = (levels & bit) != 0;
  EventTally& arrival = level ? rising_[channel] : falling_[channel];
  EventTally& departure = level ? falling_[channel] : rising_[channel];
  if (level == was) {
    departure.count_in_interrupt();
  }
  arrival.count_in_interrupt();
  levels_.store_in_interrupt(static_cast<std::uint16_t>(level ? levels | bit : levels & ~bit));
  edges_.store_in_interrupt(static_cast<std::uint8_t>(edges_.load() + 1U));
}

void Inputs::collect(InputEdges& edges, unsigned channels) {
  const std::uint32_t modulus = range_ == CounterRange::FiveDigits ? 100'000U : 65'536U;
  levels_ = static_cast<std::uint16_t>(edges.levels() & ((1U << channels) - 1U));
  for (unsigned channel = 0; channel < channels; ++channel) {
    const auto bit = static_cast<std::uint16_t>(1U << channel);
    const std::uint16_t rising = edges.rising(channel).collect();
    const std::uint16_t falling = edges.falling(channel).collect();
    latched_high_ = static_cast<std::uint16_t>(latched_high_ | (rising != 0 ? bit : 0U));
    latched_low_ = static_cast<std::uint16_t>(latched_low_ | (falling != 0 ? bit : 0U));
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
