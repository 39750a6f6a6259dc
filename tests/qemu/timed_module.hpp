// A module in emulated time. Its timers run as on a real module, but the UART of the emulated board sends
// bytes immediately, its EEPROM stores bytes immediately, and each instruction takes 16 ns.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/qemu/alarm_clock.hpp"
#include "tests/qemu/emulated_board.hpp"
#include "tests/qemu/lamp_watch.hpp"
#include "tests/qemu/wrong_mode.hpp"

namespace ex9000::rig {

/// The module is stopped between calls. The same calls have the same effects, independently of the host, with
/// the exception that alarm_clock.hpp states.
class TimedModule : public EmulatedBoard {
 public:
  using Bytes = std::vector<std::uint8_t>;

  explicit TimedModule(const Model& model) : EmulatedBoard(model, nullptr) {}

  /// Replaces the module with a new module whose supply is on; see EmulatedBoard::renew. Sets `now()` to 0.
  void begin_anew(const Settings* settings);
  /// Switches the supply on or off. No time passes.
  void power(bool on);
  /// Switches the supply off and kills the emulator. Only the file of the EEPROM remains. No time passes.
  void kill();
  /// Resets the module with the reset pin. Has no effect without power. No time passes.
  void reset();
  /// Sets the level of an input channel; 100 us pass. Ignores channels that the model does not have.
  void set_input(unsigned channel, bool level);
  /// Generates `count` pulses from the present level and back, one every 8 us. Has no effect without power,
  /// or if the model does not have that channel. If the module has not run since its last start, edges are
  /// lost.
  void pulse_input(unsigned channel, std::uint32_t count);

  /// Lets time pass. The image runs if the module is powered.
  void run_for(std::chrono::nanoseconds time);
  /// Returns the time that has passed since the module was created or last replaced by `begin_anew`.
  [[nodiscard]] std::chrono::nanoseconds now() const { return now_; }

  /// Runs until the watchdog or the image is about to reset the module. The emulator must then send `event`.
  /// It sends `WATCHDOG` only for a reset by the watchdog, and `SHUTDOWN` for a reset by the watchdog or by
  /// the image. Throws std::runtime_error if this event does not occur within `time`. `now()` omits up to
  /// 50 ms of the time before the reset. Call `reset` before the module runs again.
  void run_to_reset(const std::string& event, std::chrono::nanoseconds time);

  /// Waits up to 100 ms until the driver enable is off, then sends bytes in `mode`. Returns when the last
  /// byte has ended. The module loses bytes that arrive while its driver enable is on. The only line error
  /// that the emulated UART supports is a break. Therefore a byte arrives as a break if a receiver in the
  /// module's mode finds any line error in the byte. The rate of `mode` must not be 0.
  void send(const Bytes& bytes, hal::SerialMode mode);
  /// Returns the bytes that a receiver in `mode` has received from the module since the last call or since
  /// the last start of the module, whichever is later. Includes bytes with line errors. Returns no bytes if
  /// the supply is off. No time passes.
  Bytes hear(hal::SerialMode mode);
  /// Returns whether the module is powered and its driver enable was on at the last stop.
  [[nodiscard]] bool speaks() const { return powered() && clock_->driver_on(); }

  /// Returns the number of instructions that the image had executed at the last stop, since the emulator was
  /// started. The module must be powered.
  [[nodiscard]] std::uint64_t instructions() const { return clock_->instructions(); }

  /// Assumes that the LED is steadily on. If LampWatch detects during a later call that the LED flashes, that
  /// call throws std::runtime_error.
  void assume_led_on() { lamp_.believe(now_); }
  /// Lets time pass until the assumption about the LED is verified. Call this function only if the extra time
  /// does not disturb later steps.
  void verify_led();

 private:
  void come_up();
  void halt();
  void run_until(std::chrono::nanoseconds when);
  void put(const Arrival& arrival);
  void hold_memory(bool hold);

  /// No value before the first power-on, and between `kill` and the next power-on.
  std::optional<AlarmClock> clock_;
  std::chrono::nanoseconds now_{0};
  LampWatch lamp_;
};

}  // namespace ex9000::rig
