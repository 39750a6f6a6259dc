// Noise on the wires: bits that arrive as their opposites, characters that are lost, and characters that
// nobody has sent.
#pragma once

#include <cstdint>
#include <deque>

#include "sim/bus.hpp"
#include "sim/faults/chance.hpp"

namespace ex9000::sim {

/// How often it strikes; each is a probability, 0 to 1.
struct NoiseRates {
  double flipped_bit = 0;     ///< of each bit, start and stop bits among them
  double lost_character = 0;  ///< of each character: receivers see an idle line
  /// Behind each character: one with any byte, right behind it; where the sender goes straight on, the two
  /// collide.
  double stray_character = 0;
  double stray_zero = 0;       ///< likewise, a 00, as the turn-around of a line makes them
  double lost_in_a_fight = 0;  ///< of each 0 that is sent while another driver is on and holds the idle level
};

/// The same seed and the same line make the same noise.
class Noise final : public Disturbance, public Station {
 public:
  /// Attaches itself to `bus`, and disturbs it from now on.
  Noise(Bus& bus, NoiseRates rates, std::uint64_t seed);
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  void set_rates(NoiseRates rates) { rates_ = rates; }
  /// Characters that it has changed, taken away or made, since it exists.
  [[nodiscard]] std::uint64_t strikes() const { return strikes_; }

  // --- Disturbance ---
  Levels disturbed(const Sent& sent) override;

  // --- Station ---
  [[nodiscard]] VirtualTime next() const override { return strays_.empty() ? kNever : strays_.front().at; }
  void run() override;
  [[nodiscard]] std::uint32_t baud() const override { return 0; }
  void receive(std::uint8_t /*byte*/, ByteStatus /*status*/) override {}

 private:
  struct Stray {
    VirtualTime at;
    std::uint8_t byte;
    std::uint32_t baud;
  };

  Wire& wire_;
  NoiseRates rates_;
  Chance chance_;
  std::uint64_t strikes_ = 0;
  std::deque<Stray> strays_;  ///< that are still to come, the next one first
  bool straying_ = false;
};

}  // namespace ex9000::sim
