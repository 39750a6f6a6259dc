#include "sim/virtual_line/line/input_program.hpp"

#include <algorithm>

namespace ex9000::sim {

namespace {

/// Bounces within the bounce time.
constexpr unsigned kChatters = 4;

}  // namespace

MovedInput::MovedInput(Wires& wires, SimulatedModule& module, const InputProgram& program, std::uint64_t seed)
    : clock_(wires.clock()), end_(wires.attach(*this)), module_(module), program_(program), chance_(seed) {
  const VirtualTime now = clock_.virtual_now();
  plan(program.kind == InputProgram::Kind::Square     ? now
       : program.kind == InputProgram::Kind::KeyAgain ? now + program.time
                                                      : std::max(now, program.time));
  end_.run_at(moves_.front().when);
}

void MovedInput::plan(VirtualTime begins) {
  chatter(begins, true);
  chatter(begins + program_.high, false);
  if (program_.kind != InputProgram::Kind::KeyOnce) {
    again_ = begins + program_.time;
  }
}

/// Plans a change and its bounces: real contacts open and close several times before they settle.
void MovedInput::chatter(VirtualTime begins, bool level) {
  moves_.push_back({begins, level});
  if (program_.bounce == VirtualTime(0)) {
    return;
  }
  const VirtualTime slot = program_.bounce / kChatters;
  const auto less_than_half_a_slot = [&] {
    return VirtualTime(chance_.number() % static_cast<std::uint64_t>(slot.count() / 2));
  };
  for (unsigned i = 0; i < kChatters; ++i) {
    const VirtualTime parts = begins + slot * i + VirtualTime(1) + less_than_half_a_slot();
    moves_.push_back({parts, !level});
    moves_.push_back({parts + less_than_half_a_slot(), level});
  }
}

void MovedInput::run() {
  while (!moves_.empty() && moves_.front().when <= clock_.virtual_now()) {
    module_.set_input(program_.channel, moves_.front().level);
    moves_.pop_front();
    if (moves_.empty() && again_ != kNever) {
      plan(again_);
    }
  }
  end_.run_at(moves_.empty() ? kNever : moves_.front().when);
}

}  // namespace ex9000::sim
