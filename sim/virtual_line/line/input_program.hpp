// Programs that change the level of a module's input: square waves and key presses.
//
//   0 square 100ms                          on for one half of the period, off for the other half
//   3 key at 2s for 300ms                   pressed once
//   3 key every 10s for 300ms bounce 5ms    pressed every 10 s; the contacts bounce for 5 ms
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "sim/virtual_line/bus/bus.hpp"
#include "sim/virtual_line/bus/module.hpp"
#include "sim/virtual_line/bus_faults/chance.hpp"

namespace ex9000::sim {

struct InputProgram {
  enum class Kind { Square, KeyOnce, KeyAgain };

  unsigned channel = 0;
  Kind kind = Kind::Square;
  VirtualTime time{0};    ///< Square, KeyAgain: the period; KeyOnce: the line time of the key press
  VirtualTime high{0};    ///< how long the input is on
  VirtualTime bounce{0};  ///< how long the contacts bounce after each change
};

/// Parses a program. `model` defines which channels exist. Throws std::invalid_argument with a one-line
/// message that says what is wrong and what would be right.
InputProgram parse_input_program(const std::string& text, const Model& model);

/// Parses the number of an input channel of this model. Throws std::invalid_argument with a one-line message.
unsigned parse_input(const std::string& text, const Model& model);

/// Changes the level of one input, even if the module has no power.
class MovedInput final : public Station {
 public:
  /// Attaches itself to `bus` and starts the program now. The same `seed` produces the same bouncing.
  MovedInput(Bus& bus, SimulatedModule& module, const InputProgram& program, std::uint64_t seed);
  MovedInput(const MovedInput&) = delete;
  MovedInput& operator=(const MovedInput&) = delete;

  // --- Station ---
  void run() override;

 private:
  struct Move {
    VirtualTime when;
    bool level;
  };

  void plan(VirtualTime begins);
  void chatter(VirtualTime begins, bool level);

  VirtualClock& clock_;
  BusEnd& end_;
  SimulatedModule& module_;
  InputProgram program_;
  Chance chance_;
  std::deque<Move> moves_;
  VirtualTime again_ = kNever;  ///< time of the next repetition; kNever: none
};

}  // namespace ex9000::sim
