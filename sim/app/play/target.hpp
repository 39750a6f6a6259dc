// The interface through which the player uses the modules.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/app/play/transcript.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

enum class Led { On, Off, Flashing };
constexpr const char* led_text(Led led) {
  return led == Led::On ? "on" : led == Led::Off ? "off" : "flashing";
}

/// A module and the master's end of its line. Of several modules, a target acts on one at a time. Each call
/// lets the required time pass, and returns when its action is complete.
class Target {
 public:
  Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual ~Target() = default;

  /// Once before a transcript, not for a scenario: provides a module with the supply on, INIT* released and
  /// the inputs off. `preset`: in its memory; null: nothing.
  virtual void start(const Model& model, const Settings* preset) = 0;

  /// Without a gap, at the master's rate.
  virtual void send(const Bytes& bytes) = 0;
  /// Returns when `count` bytes have arrived, or none for `patience`.
  virtual Bytes receive(std::size_t count, std::chrono::milliseconds patience) = 0;
  /// Lets `time` pass, then returns what no earlier call has returned.
  virtual Bytes listen(std::chrono::nanoseconds time) = 0;
  /// Both: of the master.
  virtual void set_baud(std::uint32_t rate) = 0;
  virtual void set_format(LineFormat format) = 0;

  /// Switched on, the module gets the time to start up.
  virtual void power(bool on) = 0;
  /// Without loss of power; the module gets the time to start up.
  virtual void reset() = 0;
  virtual void set_init(bool asserted) = 0;
  virtual void set_input(unsigned channel, bool level) = 0;
  virtual void pulse_input(unsigned channel, std::uint32_t count) = 0;
  virtual std::uint16_t outputs() = 0;
  /// `expected`: for a target that can only watch the LED, to choose how long.
  virtual Led led(Led expected) = 0;

  // For several modules and faults. Throw if the module or the line does not exist, or like sim::act.

  /// For the following calls. `position`: from 0, across all lines. The master sends on its line.
  virtual void choose_module(std::size_t /*position*/) {
    throw std::runtime_error("there is only one module");
  }
  /// The first module of the line.
  virtual void choose_line(const std::string& /*name*/) {
    throw std::runtime_error("there is only one line");
  }
  /// As sim::act: `N ACTION`, or `ACTION` of the chosen line.
  virtual std::string act(const sim::Words& /*words*/) {
    throw std::runtime_error("this target has no actions");
  }

  /// When all steps have passed. std::runtime_error: an error that no step has reported.
  virtual void end() {}
};

}  // namespace ex9000::play
