#include "sim/virtual_line/faults/noise.hpp"

namespace ex9000::sim {

Noise::Noise(Wires& wires, NoiseRates rates, std::uint64_t seed)
    : wire_(wires.attach(*this)), rates_(rates), chance_(seed) {
  wires.disturb(*this);
}

Levels Noise::disturbed(const Sent& sent) {
  if (straying_) {
    return sent.levels;
  }
  Levels levels = sent.levels;
  for (unsigned bit = 0; bit < bits_received(sent.mode.format); ++bit) {
    const auto mask = static_cast<Levels>(1U << bit);
    if (chance_.happens(rates_.flipped_bit)) {
      levels = static_cast<Levels>(levels ^ mask);
    }
    if (sent.contended && (levels & mask) == 0 && chance_.happens(rates_.lost_in_contention)) {
      levels = static_cast<Levels>(levels | mask);
    }
  }
  if (chance_.happens(rates_.lost_character)) {
    levels = kIdleLevels;
  }
  const bool zero = chance_.happens(rates_.stray_zero);
  if (zero || chance_.happens(rates_.stray_character)) {
    const std::uint8_t byte = zero ? 0 : static_cast<std::uint8_t>(chance_.number());
    strays_.emplace(sent.ends, std::pair(byte, sent.mode));
    wait_for_next();
  }
  changes_ += levels != sent.levels ? 1U : 0U;
  return levels;
}

/// Enables no driver: no device sends the stray character.
void Noise::run() {
  const auto [byte, mode] = strays_.begin()->second;
  strays_.erase(strays_.begin());
  ++changes_;
  straying_ = true;
  wire_.put({byte, mode});
  straying_ = false;
  wait_for_next();
}

void Noise::wait_for_next() { wire_.run_at(strays_.empty() ? kNever : strays_.begin()->first); }

}  // namespace ex9000::sim
