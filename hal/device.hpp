// Connects the module to its peripherals, on every board and in every simulated module.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/module.hpp"
#include "hal/memory.hpp"

namespace ex9000::hal {

/// A module on a board, from one reset to the next. The board's composition file, for example
/// boards/rp2040/composition.cpp, creates it, calls `start` and makes the interrupts call the `on_...`
/// functions. The main loop then repeats: `turn` until it returns false, then sleep until `has_work`.
///
/// `Board` has these drivers, or references to them; a header in hal/ is the contract of each:
///     clock                       clock.hpp             outputs        outputs.hpp
///     line                        serial_line.hpp       memory         memory.hpp
///     silence_timer, wake_timer   one_shot_timer.hpp    init_switch    init_switch.hpp
///     inputs                      inputs.hpp            status_led     status_led.hpp
///     watchdog                    watchdog.hpp          kept_word      kept_word.hpp
///     slots, if the image can be updated (kBuiltUpdate): image_slots.hpp
/// A board also has a tick (tick.hpp), which is no member. The compiler rejects a board that lacks a member
/// or a function, or whose function takes a narrower number (-Wconversion).
template <class Board>
class Device {
 public:
  explicit constexpr Device(const Model& model) : board_(), module_(model) {}
  /// With a copy of `board`, for example one that refers to peripherals of the caller.
  constexpr Device(const Model& model, const Board& board) : board_(board), module_(model) {}

  /// Once, after the tick has started, before the other interrupts are enabled.
  /// `serial_number`: 0x0D00xxxx, from a unique number of the board; 0: the board has none.
  void start(ResetReason reason, std::uint32_t serial_number = 0) {
    module_.start(board_.inputs.start(), board_.clock.now(),
                  {reason, serial_number, board_.kept_word.load(), origin()});
    board_.kept_word.store(module_.crashes());
    board_.watchdog.feed();
  }

  // --- interrupts, which must not interrupt each other, so they share one preemption priority ---

  /// For each byte, even with an error, but not one received while the module's own driver was on.
  void on_receive(std::uint8_t byte, ByteStatus status) {
    const Duration silence = module_.on_byte(byte, status, board_.clock);
    if (!(silence == Duration())) {
      board_.silence_timer.restart(silence);
    } else {
      // After an ASCII host OK, for example, or an ASCII request if bytes take no time on this line.
      wake_for_frame();
    }
  }
  /// When the silence timer expires: a silence is over, the turn-around time of an ASCII frame, or a window
  /// of an arbitration.
  void on_silence() {
    const Time now = board_.clock.now_in_interrupt();
    Duration more = module_.on_silence(now);
    if (module_.arbitrates()) {
      more = serve_window(now);
    }
    if (!(more == Duration())) {
      board_.silence_timer.restart(more);
    }
    wake_for_frame();
  }
  /// When the last stop bit has been sent and the driver is off.
  void on_sent() {
    module_.on_reply_sent(board_.clock.now_in_interrupt());
    wake_for_frame();  // a frame that came during the reply
  }
  /// `level`: after the edge, true = logic 1.
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
  void on_wake_timer() { wake(); }
  /// When the memory can continue its job.
  void on_memory() { wake(); }

  // --- main loop; nothing blocks ---

  [[nodiscard]] bool has_work() const { return wakes_.load() != wakes_seen_; }

  /// One pass. If true, call it again at once: work is due, and maybe no interrupt will wake the main loop.
  bool turn() {
    wakes_seen_ = wakes_.load();  // must be first, so that later events cause another pass
    const Time now = board_.clock.now();
    const bool memory_polls = poll_memory(now);
    module_.step(board_.init_switch.asserted(), now);
    // In every pass, in case a disturbance has changed the registers of outputs or LED.
    board_.outputs.drive(module_.outputs());
    board_.status_led.light(module_.led_lit());
    board_.kept_word.store(module_.crashes());
    if (module_.feed_watchdog(now)) {
      board_.watchdog.feed();
    }
    serve_line(now);
    const bool memory_begins = begin_memory_job(now);
    const bool slots_poll = serve_slots(now);
    return set_wake_timer(now) || memory_polls || memory_begins || slots_poll;
  }

  constexpr Board& board() { return board_; }
  constexpr Module& module() { return module_; }
  [[nodiscard]] const Module& module() const { return module_; }

 private:
  [[gnu::noinline]] Duration serve_window(Time now) {
    const Duration next = module_.on_window(now, board_.line.low());
    const Bytes burst = module_.take_burst();
    if (burst.size != 0) {
      board_.line.send_in_interrupt(burst);
    }
    return next;
  }

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

  void wake() { wakes_.store_in_interrupt(wakes_.load() + 1U); }
  void wake_for_frame() {
    if (module_.frame_waits()) {
      wake();
    }
  }

  /// Also between jobs. True: call it again at once.
  bool poll_memory(Time now) {
    const bool polls_again = board_.memory.poll(now);
    if (memory_job_under_way_ && !board_.memory.busy()) {
      memory_job_under_way_ = false;
      module_.memory_done(board_.memory.result());
    }
    return polls_again;
  }

  /// True if there was one, so that the memory must be polled.
  bool begin_memory_job(Time now) {
    if (memory_job_under_way_ || !module_.needs_memory()) {
      return false;
    }
    board_.memory.start(module_.memory_job(), now);
    memory_job_under_way_ = true;
    return true;
  }

  /// True: call it again at once.
  bool serve_slots(Time now) {
    if constexpr (kBuiltUpdate) {
      if (module_.wants_reset()) {
        board_.watchdog.restart();
      }
      const bool polls_again = board_.slots.poll(now);
      if (slot_job_under_way_ && !board_.slots.busy()) {
        slot_job_under_way_ = false;
        module_.slot_done();
        return true;
      }
      if (slot_job_under_way_ || !module_.needs_slots()) {
        return polls_again;
      }
      board_.slots.start(module_.slot_job(), now);
      slot_job_under_way_ = true;
      return true;
    }
    return false;
  }

  [[nodiscard]] update::Origin origin() const {
    if constexpr (kBuiltUpdate) {
      return board_.slots.origin();
    }
    return {};
  }

  /// To the next deadline or poll of the memory. True instead if the deadline is already reached. `now` is
  /// the start of the pass, so the timer is late by its duration; the delays of several passes do not add up.
  bool set_wake_timer(Time now) {
    Deadline next = module_.next_deadline();
    if (memory_job_under_way_ || slot_job_under_way_ || module_.activating()) {
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
  bool slot_job_under_way_ = false;
  std::uint32_t wakes_seen_ = 0;
  WrittenByInterrupt<std::uint32_t> wakes_;
  Module module_;
};

}  // namespace ex9000::hal
