// Changes the level of a module's input: square waves and key presses.
#pragma once

#include <cstdint>
#include <deque>

#include "sim/virtual_line/faults/chance.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

struct InputProgram {
  enum class Kind { Square, KeyOnce, KeyAgain };

  unsigned channel = 0;
  Kind kind = Kind::Square;
  VirtualTime time{0};    ///< Square, KeyAgain: the period; KeyOnce: the line time of the key press
  VirtualTime high{0};    ///< how long the input is on
  VirtualTime bounce{0};  ///< how long the contacts bounce after each change
};

/// Starts when constructed; needs no power at the module. The same `seed` gives the same bouncing.
class MovedInput final : public Station {
 public:
  MovedInput(Wires& wires, SimulatedModule& module, const InputProgram& program, std::uint64_t seed);
  MovedInput(const MovedInput&) = delete;
  MovedInput& operator=(const MovedInput&) = delete;

  void run() override;

 private:
  struct Move {
    VirtualTime when;
    bool level;
  };

  void plan(VirtualTime begins);
  void chatter(VirtualTime begins, bool level);

  VirtualClock& clock_;
  WireEnd& end_;
  SimulatedModule& module_;
  InputProgram program_;
  Chance chance_;
  std::deque<Move> moves_;
  VirtualTime again_ = kNever;  ///< time of the next repetition; kNever: none
};

}  // namespace ex9000::sim
