// The module on its peripherals: what every board and every simulated module runs.
#pragma once

#include <cstdint>

#include "firmware/module.hpp"
#include "hal/clock.hpp"
#include "hal/init_switch.hpp"
#include "hal/inputs.hpp"
#include "hal/memory.hpp"
#include "hal/outputs.hpp"
#include "hal/serial_line.hpp"
#include "hal/silence_timer.hpp"
#include "hal/status_led.hpp"
#include "hal/tick.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal {

/// What a board provides.
struct Board {
  Clock& clock;
  SerialLine& line;
  SilenceTimer& silence_timer;
  Inputs& inputs;
  Outputs& outputs;
  Memory& memory;
  InitSwitch& init_switch;
  StatusLed& status_led;
  Tick& tick;
  Watchdog& watchdog;
};

/// Lives from one reset to the next. A composition file makes one, calls `start`, points the interrupts at
/// the `on_...` functions and calls `turn` for ever.
class Device {
 public:
  constexpr Device(const Model& model, const Board& board) : module_(model), board_(board) {}

  /// Once, before interrupts are enabled. `tick` is the period that suits the board, see Tick::start;
  /// `timing_at` what Module::begin wants.
  void start(Duration tick, TimingAt timing_at = LineTiming::at);

  // --- interrupts; on_receive and on_silence share a priority, the others may have their own ---

  /// A byte was received, good or not; what comes while the own driver is on is the echo and is ignored.
  void on_receive(std::uint8_t byte, ByteStatus status);
  void on_silence();
  void on_edge(unsigned channel, bool level) { module_.on_edge(channel, level); }
  void on_tick() { module_.on_tick(); }

  // --- main loop ---

  /// One turn of the main loop; does not block.
  void turn();

  [[nodiscard]] const Module& module() const { return module_; }

 private:
  void look_after_line(Time now);
  void look_after_memory();

  Module module_;
  const Board& board_;
  bool line_open_ = false;
  bool reply_under_way_ = false;
  bool memory_job_under_way_ = false;
};

}  // namespace ex9000::hal
