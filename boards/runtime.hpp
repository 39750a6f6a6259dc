// What every image does: the order of its start, its interrupt handlers and its main loop.
#pragma once

#include <cstdint>

#include "firmware/line/verdict.hpp"
#include "firmware/reset_reason.hpp"
#include "firmware/time.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/inputs.hpp"

namespace ex9000::board {

/// `device`: the hal::Device of the composition. `Tick` and the timers have static functions.
///
/// A composition starts a board in this order:
///
///   1. The watchdog, so that it can reset the MCU if a later step hangs. If this hides the reason of the
///      reset, the composition reads the reason first.
///   2. The pins, with `start_pins`.
///   3. The clocks, the pins of the UART, and the memory.
///   4. The module, with `start_module`.
///   5. The interrupts, with one preemption priority, so that no handler interrupts another one. If both are
///      pending, the handler of the silence timer must run before that of the line (hal/one_shot_timer.hpp).
template <auto& device, class Tick, class SilenceTimer, class LineEndTimer, class WakeTimer>
struct Runtime {
  /// Starts the outputs first, because their pins float until then.
  static void start_pins() {
    auto& board = device.board();
    board.outputs.start();
    board.line.start();
    board.init_switch.start();
    board.status_led.start();
    board.inputs.make_inputs();
  }

  static void start_module(ResetReason reason, std::uint32_t serial_number = 0) {
    SilenceTimer::start();
    LineEndTimer::start();
    WakeTimer::start();
    Tick::start();
    const Time begin = device.board().clock.now();
    while (!(hal::kPullsSettle < device.board().clock.now().since(begin))) {
    }
    device.start(reason, serial_number);
  }

  // --- interrupts ---

  static void on_line() {
    device.board().line.on_interrupt(
        [](std::uint8_t byte, ByteStatus status) { device.on_receive(byte, status); });
  }
  static void on_silence_timer() {
    if (SilenceTimer::take_expiry()) {
      device.on_silence();
    }
  }
  static void on_line_end_timer() {
    if (LineEndTimer::take_expiry() && device.board().line.on_end_timer()) {
      device.on_sent();
    }
  }
  static void on_wake_timer() {
    if (WakeTimer::take_expiry()) {
      device.on_wake_timer();
    }
  }

  [[noreturn]] static void run_main_loop() {
    for (;;) {
      while (device.turn()) {
      }
      hal::cortex_m::Interrupts::sleep_until([] { return device.has_work(); });
    }
  }
};

}  // namespace ex9000::board
