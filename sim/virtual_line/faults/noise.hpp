// Noise on the wires: changed bits, lost characters, and characters that no station has sent.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "sim/virtual_line/faults/chance.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

/// Probabilities from 0 to 1.
struct NoiseRates {
  double flipped_bit = 0;     ///< for each bit, including the start, parity and first stop bit
  double lost_character = 0;  ///< for each character: receivers see an idle line
  /// For each character: a random byte follows at once, and collides with a next one that has no gap.
  double stray_character = 0;
  /// For each character: a byte 00 follows at once, as at the turn-around of a real line.
  double stray_zero = 0;
  /// For each 0 bit of a character that begins while another driver is enabled: receivers see the idle level.
  double lost_in_contention = 0;
};

/// Disturbs `wires` from its construction on. The same seed, rates and traffic give the same noise.
class Noise final : public Disturbance, public Station {
 public:
  Noise(Wires& wires, NoiseRates rates, std::uint64_t seed);
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  void set_rates(NoiseRates rates) { rates_ = rates; }
  /// Characters changed, removed or added so far.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  Levels disturbed(const Sent& sent) override;

  void run() override;

 private:
  void wait_for_next();

  WireEnd& wire_;
  NoiseRates rates_;
  Chance chance_;
  std::uint64_t changes_ = 0;
  /// Not sent yet, each with its time.
  std::multimap<VirtualTime, std::pair<std::uint8_t, SerialMode>> strays_;
  bool straying_ = false;
};

}  // namespace ex9000::sim
