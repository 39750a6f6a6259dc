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

/// What the status LED shows.
enum class Led { On, Off, Flashing };
constexpr const char* led_text(Led led) {
  return led == Led::On ? "on" : led == Led::Off ? "off" : "flashing";
}

/// A module and the master's end of its line. A target with several modules acts on one of them at a time.
/// Each call returns when its action is complete; the target lets the required time pass.
class Target {
 public:
  Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual ~Target() = default;

  /// Provides a module of this model. The memory of the module contains `preset`, or nothing if `preset` is
  /// null. The supply is on, INIT* is released, and the inputs are off. Called once for each transcript,
  /// before the other functions; not called for a scenario.
  virtual void start(const Model& model, const Settings* preset) = 0;

  /// Sends `bytes` on the line without a gap, at the master's rate.
  virtual void send(const Bytes& bytes) = 0;
  /// Returns the received bytes when `count` bytes have arrived, or when no byte has arrived for `patience`.
  virtual Bytes receive(std::size_t count, std::chrono::milliseconds patience) = 0;
  /// Lets `time` pass, then returns the received bytes that no earlier call has returned.
  virtual Bytes listen(std::chrono::nanoseconds time) = 0;
  /// These functions set the rate and the line format of the master.
  virtual void set_baud(std::uint32_t rate) = 0;
  virtual void set_format(LineFormat format) = 0;

  /// Switches the supply. After switching on, returns when the module has had the time to start up.
  virtual void power(bool on) = 0;
  /// Resets the module without loss of power, and returns when the module has had the time to start up.
  virtual void reset() = 0;
  virtual void set_init(bool asserted) = 0;
  virtual void set_input(unsigned channel, bool level) = 0;
  virtual void pulse_input(unsigned channel, std::uint32_t count) = 0;
  virtual std::uint16_t outputs() = 0;
  /// Returns the state of the LED. `expected` is the state in the step. A target that can only watch the LED
  /// may use `expected` to choose how long to watch.
  virtual Led led(Led expected) = 0;

  // Functions for a target with several modules and with faults. They throw std::invalid_argument if the
  // module or the line does not exist, or like sim::act. The implementations in this class always throw.

  /// Chooses the module for the following calls. `position` is the position of the module, from 0, across all
  /// lines. The master then sends on the line of this module.
  virtual void choose_module(std::size_t /*position*/) {
    throw std::runtime_error("there is only one module");
  }
  /// Chooses the first module of the line with this name.
  virtual void choose_line(const std::string& /*name*/) {
    throw std::runtime_error("there is only one line");
  }
  /// Carries out an action (sim/notation/actions.hpp): `N ACTION`, or `ACTION` of the chosen line.
  virtual void act(const sim::Words& /*words*/) { throw std::runtime_error("this target has no actions"); }

  /// Called at the end of a run if all steps have passed. Throws std::runtime_error if the target has found
  /// an error that no step has reported.
  virtual void end() {}
};

}  // namespace ex9000::play
