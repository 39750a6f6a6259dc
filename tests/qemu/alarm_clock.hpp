// The emulated machine's time: it runs for as long as it is told to, and then stands still.
#pragma once

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "tests/qemu/emulator.hpp"
#include "tests/qemu/signals.hpp"

namespace ex9000::rig {

/// The machine has halted by itself: the image is about to be reset, by itself or by its watchdog.
class Halted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What happens in the machine depends on nothing but what is done to it while it stands still. Only where
/// the emulator lets time pass for a processor that has just fallen asleep, it may at times, by the host's
/// doing, forget the last instructions: of a hundred transcripts one ends up to 2 us apart from the run
/// before, where inputs are pulsed up to 7 us.
///
/// GPTM3, which no image uses, interrupts when the time is over, and the interrupt's code, in RAM that no
/// image uses, comes to the gate (gate.cpp), where its processor waits. The image itself and its vectors stay
/// as they are; a copy of these, with one more entry, takes their place. Its interrupt waits for others and
/// holds them up, as the image's own do, for 1 us each time the machine stands still; on the stack it takes
/// as much as they.
///
/// Whatever is not as it should be throws std::runtime_error, and Halted if the image is about to be reset.
class AlarmClock {
 public:
  explicit AlarmClock(Emulator& machine) : machine_(machine) {}

  /// Behind every reset, before the first instruction.
  void set_up();
  /// Runs the machine. Less than 3 us takes 3 us.
  void run_for(std::chrono::nanoseconds time);
  /// Gives an input `edges` edges, one about each 4 us, and runs the machine meanwhile. Returns how long.
  std::chrono::nanoseconds make_edges(Pin pin, std::uint32_t edges);

  /// From now on the machine stops in front of every store to these bytes of the bus as well: then only
  /// `run_to_store` is left.
  void watch_stores(std::uint32_t address, std::uint32_t size);
  /// Runs the machine until there is one, for as long as the first call says at most. Whether there was.
  bool run_to_store(std::chrono::nanoseconds time);

  /// Halts the emulator itself, as for a reset: until then it only waits for its processor. Then the machine
  /// may be reset or run again.
  void halt();

  // --- how it was when it came to a stop ---

  [[nodiscard]] bool receiver_empty() const;
  [[nodiscard]] bool driver_on() const;
  [[nodiscard]] bool led_lit() const;

 private:
  void run(std::uint32_t clocks, const std::string& orders = {});
  void begin_to_run(std::uint32_t clocks, const std::string& orders);
  void go_on();
  std::uint32_t clocks(std::chrono::nanoseconds time);
  bool wait_for_alarm();

  Emulator& machine_;
  bool at_first_ = true;       ///< no alarm has gone off yet
  bool at_gate_ = false;       ///< it waits there
  const char* go_on_ = "c";    ///< what it waits for else
  bool at_store_ = false;      ///< it has stopped in front of one, and the alarm is still to come
  std::string watched_;        ///< as the debugger names it
  std::uint32_t ordered_ = 0;  ///< the time until the next alarm, in clocks
  std::uint32_t told_ = 0;     ///< by the interrupt's code
};

}  // namespace ex9000::rig
