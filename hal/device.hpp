// Connects the module to its peripherals. Every board and every simulated module uses the class `Device`.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/module.hpp"
#include "hal/memory.hpp"

namespace ex9000::hal {

/// A module on a board. The object exists from one reset to the next. The composition file of a board, for
/// example boards/rp2040/composition.cpp, creates the object, calls `start`, and makes the interrupts call
/// the `on_...` functions. Then the main loop repeats two steps: it calls `turn` until `turn` returns false,
/// and sleeps until `has_work` returns true. Each turn does what is due, once.
///
/// `Board` is a struct of drivers, or of references to drivers, with these members. Each header in hal/ is
/// the contract of a driver.
///
///     clock                       clock.hpp             outputs        outputs.hpp
///     line                        serial_line.hpp       memory         memory.hpp
///     silence_timer, wake_timer   one_shot_timer.hpp    init_switch    init_switch.hpp
///     inputs                      inputs.hpp            status_led     status_led.hpp
///     watchdog                    watchdog.hpp
///
/// A board also has a tick (tick.hpp), which is not a member. The compiler rejects a board that lacks a
/// member or a function, or has a function that takes a narrower number (-Wconversion).
template <class Board>
class Device {
 public:
  /// Creates a device with its own board.
  explicit constexpr Device(const Model& model) : board_(), module_(model) {}
  /// Creates a device with a copy of `board`, for example of a board that refers to peripherals of the
  /// caller.
  constexpr Device(const Model& model, const Board& board) : board_(board), module_(model) {}

  /// Starts the module. Call this once, after the tick has started and before the other interrupts are
  /// enabled. `reason`: why the board was reset.
  void start(ResetReason reason) {
    module_.start(board_.inputs.start(), board_.clock.now(), reason);
    board_.watchdog.feed();
  }

  // --- interrupts ---
  // Interrupts call these functions. These interrupts must not interrupt each other, so they share one
  // preemption priority.

  /// Processes a received byte. Call this for each byte, even if it has an error, but not for a byte that was
  /// received while the module's own driver was on.
  void on_receive(std::uint8_t byte, ByteStatus status) {
    const Duration silence = module_.on_byte(byte, status, board_.clock);
    if (!(silence == Duration())) {
      board_.silence_timer.restart(silence);
    } else {
      // For example, `silence` is 0 after an ASCII host OK, and after an ASCII request if bytes take no time
      // on this line.
      wake_for_frame();
    }
  }
  /// Processes the end of the silence after a byte, or of the turn-around time after an ASCII frame. Call
  /// this when the silence timer expires.
  void on_silence() {
    const Duration more = module_.on_silence(board_.clock.now_in_interrupt());
    if (!(more == Duration())) {
      board_.silence_timer.restart(more);
    }
    wake_for_frame();
  }
  /// Processes the end of a reply. Call this when the last stop bit has been sent and the driver is off.
  void on_sent() {
    module_.on_reply_sent(board_.clock.now_in_interrupt());
    wake_for_frame();  // a frame that came during the reply
  }
  /// Processes an edge of an input. `channel`: counted from 0; `level`: the level after the edge, true =
  /// logic 1.
  void on_edge(unsigned channel, bool level) {
    const bool filtered = module_.edges_need_times();
    module_.on_edge(channel, level, filtered ? board_.clock.now_in_interrupt() : Time());
    if (filtered) {
      wake();  // `turn` must set the wake timer to the end of the filter time
    }
  }
  void on_tick() {
    module_.on_tick();
    wake();
  }
  /// Call this when the wake timer expires.
  void on_wake_timer() { wake(); }
  /// Call this when the memory can continue its job.
  void on_memory() { wake(); }

  // --- main loop; no function blocks ---

  [[nodiscard]] bool has_work() const { return wakes_.load() != wakes_seen_; }

  /// Runs one pass of the main loop. If the result is true, call this again immediately: work is due, and
  /// there may be no interrupt that wakes the main loop in time.
  bool turn() {
    wakes_seen_ = wakes_.load();  // must be first, so that later events cause another pass
    const Time now = board_.clock.now();
    const bool memory_polls = poll_memory(now);
    module_.step(board_.init_switch.asserted(), now);
    // Each pass drives outputs and LED again, in case a disturbance has changed their registers.
    board_.outputs.drive(module_.outputs());
    board_.status_led.light(module_.led_lit());
    if (module_.feed_watchdog(now)) {
      board_.watchdog.feed();
    }
    serve_line(now);
    const bool memory_begins = begin_memory_job(now);
    return set_wake_timer(now) || memory_polls || memory_begins;
  }

  constexpr Board& board() { return board_; }
  constexpr Module& module() { return module_; }
  [[nodiscard]] const Module& module() const { return module_; }

 private:
  /// Opens the line when the module has started, and begins to send a reply when it is due.
  void serve_line(Time now) {
    if (!line_open_) {
      if (!module_.listening()) {
        return;
      }
      line_open_ = true;
      module_.listen(board_.line.timing(module_.baud(), module_.format()));
      board_.line.open(module_.baud(), module_.format());
    }
    const Bytes reply = module_.take_reply(now);
    if (reply.size != 0) {
      board_.line.send(reply);
    }
  }

  /// Makes `has_work` return true, which wakes the main loop.
  void wake() { wakes_.store_in_interrupt(wakes_.load() + 1U); }
  void wake_for_frame() {
    if (module_.frame_waits()) {
      wake();
    }
  }

  /// Continues a memory job, or the work of the memory between jobs. Passes the result of a finished job to
  /// the module. Returns true if this function must be called again immediately.
  bool poll_memory(Time now) {
    const bool polls_again = board_.memory.poll(now);
    if (memory_job_under_way_ && !board_.memory.busy()) {
      memory_job_under_way_ = false;
      module_.memory_done(board_.memory.result());
    }
    return polls_again;
  }

  /// Begins the next memory job. Returns whether there was one, so that the memory must be polled.
  bool begin_memory_job(Time now) {
    if (memory_job_under_way_ || !module_.needs_memory()) {
      return false;
    }
    board_.memory.start(module_.memory_job(), now);
    memory_job_under_way_ = true;
    return true;
  }

  /// Sets the wake timer to the time until the next deadline, or until the memory must be polled. `now` is
  /// the start of this pass, so the timer expires late by the duration of the pass. The delays of several
  /// passes do not accumulate. If the deadline is already reached, returns true and does not set the timer.
  bool set_wake_timer(Time now) {
    Deadline next = module_.next_deadline();
    if (memory_job_under_way_) {
      next.advance_to(Deadline(now + kMemoryPollPeriod));
    }
    if (!next.armed()) {
      return false;
    }
    const Duration sleep = next.remaining(now);
    if (sleep == Duration()) {
      return true;
    }
    board_.wake_timer.restart(sleep);
    return false;
  }

  Board board_;
  bool line_open_ = false;
  bool memory_job_under_way_ = false;
  std::uint32_t wakes_seen_ = 0;
  WrittenByInterrupt<std::uint32_t> wakes_;
  Module module_;
};

}  // namespace ex9000::hal
