// A module in a time of its own, in which everything takes as long as it takes on a real one, except what the
// emulated board does not know: its UART sends and its EEPROM stores at once.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/qemu/alarm_clock.hpp"
#include "tests/qemu/emulated_board.hpp"
#include "tests/qemu/lamp_watch.hpp"

namespace ex9000::rig {

/// Stands still between calls. The same calls have the same effects, whatever the host does; see AlarmClock.
class TimedModule : public EmulatedBoard {
 public:
  using Bytes = std::vector<std::uint8_t>;

  explicit TimedModule(const Model& model) : EmulatedBoard(model, nullptr) {}

  /// Another one, see EmulatedBoard::renew, in no time.
  void begin_anew(const Settings* settings);
  /// The supply, in no time.
  void power(bool on);
  /// Off, and its emulator killed: nothing but the EEPROM's file is left. In no time.
  void kill();
  /// By the reset pin, in no time; none without power.
  void reset();
  /// Level of an input channel; 100 us pass. Channels the model lacks may be set and do nothing.
  void set_input(unsigned channel, bool level);
  /// `count` full pulses of 8 us from the present level and back.
  void pulse_input(unsigned channel, std::uint32_t count);

  /// Time passes, for the image where there is power.
  void run_for(std::chrono::nanoseconds time);
  /// Time that has passed.
  [[nodiscard]] std::chrono::nanoseconds now() const { return now_; }

  /// From now on `run_to_store` stops it in front of every store to these bytes of the bus; nothing else runs
  /// it any more, until it is killed.
  void watch_stores(std::uint32_t address, std::uint32_t size) { clock_->watch_stores(address, size); }
  /// Until there is one, for as long as the first call says at most. Whether there was.
  bool run_to_store(std::chrono::nanoseconds time) { return clock_->run_to_store(time); }

  /// Runs it until it is about to be reset by its watchdog (`WATCHDOG`) or by itself (`SHUTDOWN`); then only
  /// `reset` is left. Throws std::runtime_error if it is not within `time`.
  void run_to_reset(const std::string& event, std::chrono::nanoseconds time);

  /// Bytes on the line, at `baud` bits per second. What reaches a module that is speaking itself is lost.
  void send(const Bytes& bytes, std::uint32_t baud);
  /// What the module has sent so far and nobody has taken, as a receiver at `baud` hears it. Takes no time.
  Bytes hear(std::uint32_t baud);
  /// Its driver was on when it came to a stop.
  [[nodiscard]] bool speaks() const { return powered() && clock_->driver_on(); }

  /// Throws, from here or when time passes, where it flashes.
  void believe_led_on() { lamp_.believe(now_); }
  /// Nothing is to come that would disturb: time may pass until what was believed is known.
  void make_sure();

 private:
  void come_up();
  void halt();
  void run_until(std::chrono::nanoseconds when);
  void put(std::uint8_t byte);
  void hold_memory(bool hold);

  std::optional<AlarmClock> clock_;  ///< from the first power-on
  std::chrono::nanoseconds now_{0};
  LampWatch lamp_;
};

}  // namespace ex9000::rig
