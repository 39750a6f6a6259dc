// Noise on the wires: changed bits, lost characters, and characters that no station has sent.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "sim/virtual_line/faults/chance.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

/// The frequency of each kind of noise, as a probability from 0 to 1.
struct NoiseRates {
  double flipped_bit = 0;     ///< for each bit, including the start, parity and first stop bit
  double lost_character = 0;  ///< for each character: receivers see an idle line
  /// For each character: a random byte follows it directly. If the sender's next character also follows
  /// without a gap, the two collide.
  double stray_character = 0;
  /// For each character: a byte 00 follows it directly, as may happen at the turn-around of a real line.
  double stray_zero = 0;
  /// For each 0 bit of a character that begins while another driver is enabled: receivers see the idle level.
  double lost_in_contention = 0;
};

/// The same seed, the same rates and the same traffic produce the same noise.
class Noise final : public Disturbance, public Station {
 public:
  /// Attaches itself to `wires` and disturbs it from now on.
  Noise(Wires& wires, NoiseRates rates, std::uint64_t seed);
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  void set_rates(NoiseRates rates) { rates_ = rates; }
  /// Returns the number of characters changed, removed or added so far.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  // --- Disturbance ---
  Levels disturbed(const Sent& sent) override;

  // --- Station ---
  void run() override;

 private:
  void wait_for_next();

  WireEnd& wire_;
  NoiseRates rates_;
  Chance chance_;
  std::uint64_t changes_ = 0;
  /// The stray characters that have not been sent yet, each with its time.
  std::multimap<VirtualTime, std::pair<std::uint8_t, SerialMode>> strays_;
  bool straying_ = false;
};

}  // namespace ex9000::sim
