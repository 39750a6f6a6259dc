// The interrupt handlers and the main loop that the compositions of all boards share.
#pragma once

#include <cstdint>

#include "firmware/line/verdict.hpp"
#include "hal/cortex_m/interrupts.hpp"

namespace ex9000::board {

/// `device`: the hal::Device of the composition. The timers are one-shot timers (hal/one_shot_timer.hpp) that
/// also have the function `take_expiry`. The composition must ensure that no handler can interrupt another
/// one.
template <auto& device, class SilenceTimer, class LineEndTimer, class WakeTimer>
struct Handlers {
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
