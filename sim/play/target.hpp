// What a transcript is played against.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/play/transcript.hpp"

namespace ex9000::play {

/// A module and the master's end of its line; where there are several, one of them at a time. Every call
/// returns when it is done; where that takes time, the target lets it pass.
class Target {
 public:
  Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual ~Target() = default;

  /// A module of this model with `preset` stored (nothing stored where it is null), supply on, INIT*
  /// released, inputs off. Called once, first.
  virtual void start(const Model& model, const Settings* preset) = 0;

  /// Puts `bytes` on the line without a gap, at the master's rate.
  virtual void send(const Bytes& bytes) = 0;
  /// What is heard until `count` bytes are there or nothing came for `patience`.
  virtual Bytes receive(std::size_t count, std::chrono::milliseconds patience) = 0;
  /// What is heard while `time` passes.
  virtual Bytes listen(std::chrono::nanoseconds time) = 0;
  /// The master's rate.
  virtual void set_baud(std::uint32_t rate) = 0;

  /// The supply; after it comes on, the module has been given the time to come up.
  virtual void power(bool on) = 0;
  /// A reset with the supply on; likewise.
  virtual void reset() = 0;
  virtual void set_init(bool asserted) = 0;
  virtual void set_input(unsigned channel, bool level) = 0;
  virtual void pulse_input(unsigned channel, std::uint32_t count) = 0;
  virtual std::uint16_t outputs() = 0;
  /// `expected` is what the transcript says: a target that can but watch the lamp need not watch for longer
  /// than it takes to tell this from everything else.
  virtual step::Led::Shows led(step::Led::Shows expected) = 0;

  // Of a bus; what has but one module has no other, and no faults. They throw std::runtime_error, likewise.

  /// Which module the calls above are about from here on, from 0 through all lines, or the first of a line;
  /// the master talks on its line.
  virtual void choose_module(std::size_t /*position*/) {
    throw std::runtime_error("there is but one module");
  }
  virtual void choose_line(const std::string& /*name*/) { throw std::runtime_error("there is but one line"); }
  /// `fault FAULT`, `fault off K|all` or `faults` of that line, or `fault N FAULT` of a module, from 1
  /// through all lines.
  virtual void trouble(const std::string& /*command*/) {
    throw std::runtime_error("nothing can go wrong here");
  }

  /// The transcript is over. Throws std::runtime_error where an answer given before turns out to be wrong.
  virtual void end() {}
};

}  // namespace ex9000::play
