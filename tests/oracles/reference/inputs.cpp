// Inputs of the reference, with their filters and inversion: wire.md 5 and 12.
#include <algorithm>

#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

void Module::set_input(unsigned channel, bool level, Time now) {
  if (channel >= row_->inputs || ((terminals_ >> channel & 1U) != 0) == level) {
    return;
  }
  terminals_ ^= 1U << channel;
  last_edges_[channel] = now;
  if (!powered_) {
    return;
  }
  if (stored_.filters[channel] == 0) {
    take_level(channel);
  } else if (settling_[channel]) {
    settling_[channel].reset();
  } else {
    const Time settled = now + std::chrono::milliseconds(stored_.filters[channel]);
    settling_[channel] = Moment{settled, settled};
  }
}

void Module::pulse_input(unsigned channel, std::uint32_t count, Time now) {
  if (!powered_ || channel >= row_->inputs || count == 0) {
    return;
  }
  last_edges_[channel] = now;
  if (stored_.filters[channel] == 0) {
    // A pulse goes to the other level and back, so it has as many rising as falling edges.
    edge(channel, true, count);
    edge(channel, false, count);
  } else if (settling_[channel]) {
    const Time settled = now + std::chrono::milliseconds(stored_.filters[channel]);
    settling_[channel] = Moment{settled, settled};
  }
}

/// Accepts the new level of an input, after the filter, and processes the edge.
void Module::take_level(unsigned channel) {
  levels_ ^= 1U << channel;
  edge(channel, (levels_ >> channel & 1U) != 0, 1);
}

/// Sets a filter time, which applies from the last edge at the terminal. If this time is already over, the
/// module accepts the level as soon as the setting is stored.
void Module::set_filter(unsigned channel, unsigned milliseconds) {
  if (settling_[channel] && milliseconds != stored_.filters[channel]) {
    const Time settled = last_edges_[channel] + std::chrono::milliseconds(milliseconds);
    settling_[channel] = Moment{std::max(now_.earliest, settled), std::max(now_.latest, settled)};
  }
  set().filters[channel] = milliseconds;
}

/// Sets the inversion. The levels before and after the filter change together, so there is no edge.
void Module::set_inversion(unsigned inversion) {
  levels_ ^= inversion ^ stored_.inversion;
  set().inversion = inversion;
}

void Module::edge(unsigned channel, bool rising, std::uint32_t count) {
  (rising ? latch_high_ : latch_low_) |= 1U << channel;
  if (rising == counts_rising_) {
    const std::uint64_t edges = std::uint64_t{counters_[channel]} + count;
    counters_[channel] = static_cast<std::uint32_t>(edges % counter_modulus());
    wide_counters_[channel] += count;
  }
}

void Module::clear_counter(unsigned channel) {
  counters_[channel] = 0;
  wide_counters_[channel] = 0;
}

void Module::clear_latches() {
  latch_high_ = 0;
  latch_low_ = 0;
}

std::optional<unsigned> Module::settling_input() const {
  for (unsigned channel = 0; channel < row_->inputs; ++channel) {
    if (settling_[channel]) {
      return channel;
    }
  }
  return std::nullopt;
}

}  // namespace ex9000::reference
