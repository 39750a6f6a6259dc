// What a module's input does by itself: square waves, and keys that somebody presses.
//
//   0 square 100ms                       up for half of it, down for the other half
//   3 key at 2s for 300ms                pressed once
//   3 key every 10s for 300ms bounce 5ms contacts that chatter before they make, and as they break
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "sim/bus.hpp"
#include "sim/faults/chance.hpp"
#include "sim/module.hpp"

namespace ex9000::sim {

struct InputProgram {
  enum class Kind { Square, KeyOnce, KeyAgain };

  unsigned channel = 0;
  Kind kind = Kind::Square;
  VirtualTime time{0};    ///< Square, KeyAgain: the period; KeyOnce: since the line exists
  VirtualTime high{0};    ///< how long the input is on
  VirtualTime bounce{0};  ///< how long its contacts chatter
};

/// Throws std::invalid_argument, one line that names what is wrong and what would be right. `model` says
/// which channels there are.
InputProgram parse_input_program(const std::string& text, const Model& model);

/// Moves one input. Nothing that it does depends on whether the module has power.
class MovedInput final : public Station {
 public:
  /// Attaches itself to `bus`; begins now. The same `seed` chatters alike.
  MovedInput(Bus& bus, SimulatedModule& module, const InputProgram& program, std::uint64_t seed);
  MovedInput(const MovedInput&) = delete;
  MovedInput& operator=(const MovedInput&) = delete;

  // --- Station ---
  [[nodiscard]] VirtualTime next() const override { return moves_.empty() ? kNever : moves_.front().when; }
  void run() override;
  [[nodiscard]] std::uint32_t baud() const override { return 0; }
  void receive(std::uint8_t /*byte*/, ByteStatus /*status*/) override {}

 private:
  struct Move {
    VirtualTime when;
    bool level;
  };

  void plan(VirtualTime begins);
  void chatter(VirtualTime begins, bool level);

  VirtualClock& clock_;
  SimulatedModule& module_;
  InputProgram program_;
  Chance chance_;
  std::deque<Move> moves_;
  VirtualTime again_ = kNever;  ///< when it begins the next time
};

}  // namespace ex9000::sim
