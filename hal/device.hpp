// The module on its peripherals: what every board and every simulated module runs.
#pragma once

#include <cstdint>

#include "firmware/line/crossing.hpp"
#include "firmware/module.hpp"

namespace ex9000::hal {

/// Lives from one reset to the next. A composition file makes one, calls `start`, points the interrupts at
/// the `on_...` functions and then, for ever, `look_around` after every tick and `turn` whenever there is
/// `news`; it may sleep while there is none.
///
/// `Board` has the members of hal::Board, which say what each of them does.
template <class Board>
class Device {
 public:
  /// With a board of its own.
  explicit constexpr Device(const Model& model) : board_(), module_(model) {}
  /// On one that refers to somebody else's peripherals.
  constexpr Device(const Model& model, const Board& board) : board_(board), module_(model) {}

  /// Once, before interrupts are enabled; the tick runs already. `timing_at` is what Module::begin wants.
  void start(TimingAt timing_at = LineTiming::at) {
    module_.begin(board_.inputs.start(), board_.clock.now(), timing_at);
    board_.watchdog.feed();
  }

  // --- interrupts; on_receive and on_silence share a priority, the others may have their own ---

  /// A byte was received, good or not; what comes while the own driver is on is the echo and is ignored.
  void on_receive(std::uint8_t byte, ByteStatus status) {
    if (board_.line.sending()) {
      return;
    }
    const Duration silence = module_.on_byte(byte, status, board_.clock.now());
    if (!(silence == Duration())) {
      board_.silence_timer.restart(silence);
    }
  }
  void on_silence() {
    const Duration more = module_.on_silence();
    if (!(more == Duration())) {
      board_.silence_timer.restart(more);
    }
    if (module_.line_has_news()) {
      silences_.store_in_interrupt(silences_.load() + 1U);
    }
  }
  void on_edge(unsigned channel, bool level) { module_.on_edge(channel, level); }
  void on_tick() {
    module_.on_tick();
    wake();
  }
  /// The main loop has something to go on with: the memory, the line.
  void wake() { wakes_.store_in_interrupt(wakes_.load() + 1U); }

  // --- main loop; none of it blocks ---

  [[nodiscard]] bool news() const {
    return silences_.load() != silences_seen_ || wakes_.load() != wakes_seen_ || restless_;
  }

  /// INIT*, the status LED and the hardware watchdog: every tick.
  void look_around() {
    module_.look_around(board_.init_switch.asserted(), board_.clock.now());
    board_.status_led.light(module_.led_lit());
    if (module_.feed_watchdog()) {
      board_.watchdog.feed();
    }
  }

  /// Requests, settings and outputs.
  void turn() {
    if (silences_.load() != silences_seen_) {
      silences_seen_ = silences_.load();
      const Bytes reply = module_.answer_at_once(board_.clock.now());
      if (reply.size != 0) {
        send(reply);
        return;
      }
    }
    wakes_seen_ = wakes_.load();
    const Time now = board_.clock.now();
    look_after_memory(now);
    module_.step(now);
    board_.outputs.drive(module_.outputs());
    look_after_line(now);
    look_after_memory(now);
  }

  constexpr Board& board() { return board_; }
  [[nodiscard]] const Module& module() const { return module_; }

 private:
  void look_after_line(Time now) {
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
    module_.reply_started();
  }

  void look_after_memory(Time now) {
    if (memory_job_under_way_) {
      restless_ = board_.memory.go_on(now);
      if (board_.memory.busy()) {
        return;
      }
      memory_job_under_way_ = restless_ = false;
      module_.memory_done(board_.memory.succeeded());
    }
    if (module_.wants_memory()) {
      begin_memory_job(now);
    }
  }

  void begin_memory_job(Time now) {
    const MemoryJob job = module_.memory_job();
    if (job.kind == MemoryJob::Kind::Read) {
      board_.memory.start_read(job.address, job.bytes, now);
    } else {
      board_.memory.start_write(job.address, {job.bytes.data, job.bytes.size}, now);
    }
    memory_job_under_way_ = true;
  }

  Board board_;
  bool line_open_ = false;
  bool reply_under_way_ = false;
  bool memory_job_under_way_ = false;
  bool restless_ = false;  ///< the memory wants to be looked after without being told by an interrupt
  std::uint32_t wakes_seen_ = 0;
  std::uint32_t silences_seen_ = 0;
  WrittenByInterrupt<std::uint32_t> wakes_;
  WrittenByInterrupt<std::uint32_t> silences_;
  Module module_;
};

}  // namespace ex9000::hal
