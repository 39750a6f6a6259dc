// Controls the time of the emulated machine, which runs for a given time and then stops.
#pragma once

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "tests/qemu/emulator.hpp"
#include "tests/qemu/signals.hpp"

namespace ex9000::rig {

/// The machine has halted, because its image or its watchdog is about to reset it.
class Halted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine is stopped between calls. The same calls have the same effects, independently of the host,
/// with one exception. When the emulator advances time for a processor that has just gone to sleep, it can
/// omit the time of the last instructions, depending on the host. Therefore about one transcript in a hundred
/// ends earlier or later than in the previous run. The difference is at most 2 us, or at most 7 us if the
/// transcript contains input pulses.
///
/// The timer GPTM3, which no image uses, generates an interrupt when the requested time, or a part of it, has
/// elapsed. The interrupt code is in RAM that no image uses. At the end of the requested time, the interrupt
/// code reaches the gate (gate.cpp), where the processor waits. The image and its vectors are not changed:
/// the processor uses a copy of the vectors with an entry for this interrupt. This interrupt and the
/// interrupts of the image cannot preempt each other. This interrupt can delay an interrupt of the image by
/// up to about 0.5 us, and uses no more stack than an interrupt of the image.
///
/// The functions that access the emulator throw std::runtime_error on an unexpected state. The functions that
/// run the machine throw Halted if the machine is about to be reset.
class AlarmClock {
 public:
  explicit AlarmClock(Emulator& machine) : machine_(machine) {}

  /// Prepares the alarm. Call this after power-on and after each reset, before the first instruction.
  void set_up();
  /// Runs the machine for `time`, or for about 2.5 us if `time` is shorter.
  void run_for(std::chrono::nanoseconds time);
  /// Runs the machine and generates `edges` edges at an input, about one every 4 us. Returns the approximate
  /// duration. Between `set_up` and this call, the machine must have run; otherwise edges are lost.
  std::chrono::nanoseconds make_edges(Pin pin, std::uint32_t edges);

  /// Halts the whole machine, for example for a reset. While the processor waits at the gate, the rest of the
  /// machine is not halted. After this call the machine can be reset or can run again.
  void halt();

  // --- state when the processor last reached the gate ---

  [[nodiscard]] bool receiver_empty() const;
  [[nodiscard]] bool driver_on() const;
  [[nodiscard]] bool led_lit() const;
  /// Returns the number of instructions that the image has executed since the emulator was started.
  [[nodiscard]] std::uint64_t instructions() const { return instructions_; }

 private:
  void run(std::uint32_t clocks, const std::string& orders = {});
  void go_on();
  std::uint32_t clocks(std::chrono::nanoseconds time);
  void wait_for_alarm();

  Emulator& machine_;
  bool at_first_ = true;           ///< the machine has not run since the last reset
  bool at_gate_ = false;           ///< the processor waits at the gate
  const char* go_on_ = "c";        ///< the debugger's packet that continues a machine that is not at the gate
  std::uint32_t ordered_ = 0;      ///< the last value of kNextAlarm in alarm_clock.cpp, in clocks
  std::uint32_t last_report_ = 0;  ///< the last report of the interrupt code
  std::uint64_t instructions_ = 0;
};

}  // namespace ex9000::rig
