// The module on its peripherals: what every board and every simulated module runs.
#pragma once

#include <cstdint>

#include "firmware/line/crossing.hpp"
#include "firmware/module.hpp"
#include "hal/board.hpp"
#include "hal/memory.hpp"
#include "hal/one_shot_timer.hpp"

namespace ex9000::hal {

/// Lives from one reset to the next. A composition file makes one, calls `start`, points the interrupts at
/// the `on_...` functions and then, for ever, calls `turn` until that returns false, and sleeps until it
/// `has_work`.
///
/// `Board`: see hal/board.hpp.
template <class Board>
class Device {
  static_assert(is_board<Board>());

 public:
  /// With a board of its own. `timing_at`: see Module.
  constexpr Device(const Model& model, TimingAt timing_at) : board_(), module_(model, timing_at) {}
  /// On one that refers to somebody else's peripherals.
  constexpr Device(const Model& model, TimingAt timing_at, const Board& board)
      : board_(board), module_(model, timing_at) {}

  /// Once, before interrupts are enabled; the tick runs already.
  void start() {
    module_.start(board_.inputs.start(), board_.clock.now());
    board_.watchdog.feed();
  }

  // --- interrupts; on_receive, on_silence and on_sent share a priority, the others may have their own ---

  /// A byte was received, good or not, while the own driver was off.
  void on_receive(std::uint8_t byte, ByteStatus status) {
    const Duration silence = module_.on_byte(byte, status, board_.clock.now_in_interrupt());
    if (!(silence == Duration())) {
      board_.silence_timer.restart(silence);
    } else if (module_.request_waits()) {
      wake();  // on a line on which nothing takes time, the turn-around is over already
    }
  }
  void on_silence() {
    const Duration more = module_.on_silence();
    // A frame that is still open behind an own reply is closed by its end.
    if (!(more == Duration()) && !board_.line.sending()) {
      board_.silence_timer.restart(more);
    }
    if (module_.request_waits()) {
      wake();
    }
  }
  /// The last stop bit has left and the driver is off.
  void on_sent() {
    module_.on_spoken(board_.clock.now_in_interrupt());
    wake();
  }
  void on_edge(unsigned channel, bool level) { module_.on_edge(channel, level); }
  void on_tick() {
    module_.on_tick();
    on_wake_timer();
  }
  void on_wake_timer() {
    times_due_.store_in_interrupt(times_due_.load() + 1U);
    wake();
  }
  /// The memory can continue.
  void on_memory() { wake(); }

  // --- main loop; none of it blocks ---

  [[nodiscard]] bool has_work() const { return wakes_.load() != wakes_seen_; }

  /// Requests, settings, outputs and the panel. True: call it again at once, because no interrupt will tell
  /// when.
  bool turn() {
    wakes_seen_ = wakes_.load();  // first: what happens from here on gets a turn of its own
    const Time now = board_.clock.now();
    const bool memory_polls = poll_memory(now);
    if (panel_is_due()) {
      poll_panel();
    }
    module_.step(now);
    if (module_.outputs() != driven_) {
      drive_outputs();
    }
    poll_line(now);
    begin_memory_job(now);
    return set_wake_timer(now) || memory_polls;
  }

  constexpr Board& board() { return board_; }
  [[nodiscard]] const Module& module() const { return module_; }

 private:
  /// INIT*, the status LED and the hardware watchdog: at every tick, and when the wake timer has fired. The
  /// outputs too, whatever may have happened to their registers.
  void poll_panel() {
    module_.poll_panel(board_.init_switch.asserted(), board_.clock.now());
    board_.status_led.light(module_.led_lit());
    drive_outputs();
    if (module_.feed_watchdog()) {
      board_.watchdog.feed();
    }
  }

  void poll_line(Time now) {
    if (!line_open_) {
      if (!module_.listening()) {
        return;
      }
      line_open_ = true;
      board_.line.open(module_.baud());
    }
    if (reply_under_way_) {
      if (board_.line.sending()) {
        return;
      }
      reply_under_way_ = false;
      module_.reply_sent(board_.clock.now());  // not `now`: it may have ended since
    }
    const Bytes reply = module_.take_reply(now);
    if (reply.size != 0) {
      send(reply);
    }
  }

  void send(Bytes reply) {
    reply_under_way_ = true;
    board_.line.send(reply);
  }

  /// The tick or the wake timer has fired, or `idle_for` said that something is due.
  bool panel_is_due() {
    const std::uint32_t times_due = times_due_.load();
    const bool due = due_now_ || times_due != times_seen_;
    times_seen_ = times_due;
    return due;
  }

  /// The main loop has something to go on with.
  void wake() { wakes_.store_in_interrupt(wakes_.load() + 1U); }

  void drive_outputs() {
    driven_ = module_.outputs();
    board_.outputs.drive(driven_);
  }

  /// True: again at once.
  bool poll_memory(Time now) {
    if (!memory_job_under_way_) {
      return false;
    }
    const bool polls_again = board_.memory.poll(now);
    if (!board_.memory.busy()) {
      memory_job_under_way_ = false;
      module_.memory_done(board_.memory.succeeded());
    }
    return polls_again;
  }

  void begin_memory_job(Time now) {
    if (memory_job_under_way_ || !module_.needs_memory()) {
      return;
    }
    const MemoryJob job = module_.memory_job();
    if (job.kind == MemoryJob::Kind::Read) {
      board_.memory.start_read(job.address, job.bytes, now);
    } else {
      board_.memory.start_write(job.address, {job.bytes.data, job.bytes.size}, now);
    }
    memory_job_under_way_ = true;
  }

  /// For whatever is due next. A turn that takes some time makes it late by that, and no more. True: it is
  /// due now.
  bool set_wake_timer(Time now) {
    const Duration idle = module_.idle_for(now, memory_job_under_way_ ? kMemoryPollPeriod : kLongestWake);
    due_now_ = idle == Duration();
    if (!due_now_) {
      board_.wake_timer.restart(idle);
    }
    return due_now_;
  }

  Board board_;
  bool due_now_ = true;
  bool line_open_ = false;
  bool reply_under_way_ = false;
  bool memory_job_under_way_ = false;
  std::uint16_t driven_ = 0;
  std::uint32_t wakes_seen_ = 0;
  std::uint32_t times_seen_ = 0;  ///< of `times_due_`
  WrittenByInterrupt<std::uint32_t> wakes_;
  WrittenByInterrupt<std::uint32_t> times_due_;  ///< how often the tick or the wake timer has fired
  Module module_;
};

}  // namespace ex9000::hal
