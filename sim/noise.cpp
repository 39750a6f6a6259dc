#include "sim/noise.hpp"

namespace ex9000::sim {

Noise::Noise(Bus& bus, NoiseRates rates, std::uint64_t seed)
    : wire_(bus.attach(*this)), rates_(rates), random_(seed) {
  bus.disturb(*this);
}

/// The engine's numbers are the same everywhere; what a library's distributions make of them is not.
bool Noise::happens(double probability) {
  constexpr double kOneIn2To64 = 1.0 / 18446744073709551616.0;
  return probability > 0 && static_cast<double>(random_()) * kOneIn2To64 < probability;
}

Levels Noise::disturbed(const Sent& sent) {
  if (straying_) {
    return sent.levels;
  }
  Levels levels = sent.levels;
  for (unsigned bit = 0; bit < Wave::kBits; ++bit) {
    const auto mask = static_cast<Levels>(1U << bit);
    if (happens(rates_.flipped_bit)) {
      levels = static_cast<Levels>(levels ^ mask);
    }
    if (sent.contended && (levels & mask) == 0 && happens(rates_.lost_in_a_fight)) {
      levels = static_cast<Levels>(levels | mask);
    }
  }
  if (happens(rates_.lost_character)) {
    levels = kIdleLevels;
  }
  const bool zero = happens(rates_.stray_zero);
  if (zero || happens(rates_.stray_character)) {
    stray_ = zero ? 0 : static_cast<std::uint8_t>(random_());
    stray_baud_ = sent.baud;
    stray_at_ = sent.ends;
  }
  strikes_ += levels != sent.levels ? 1U : 0U;
  return levels;
}

/// No driver goes on: what it fights is the termination, not the sender.
void Noise::run() {
  stray_at_ = kNever;
  ++strikes_;
  straying_ = true;
  wire_.put(stray_, stray_baud_);
  straying_ = false;
}

}  // namespace ex9000::sim
