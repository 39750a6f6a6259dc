// One module without its board: the parts it is made of, and how they are connected.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/channels/inputs.hpp"
#include "firmware/line/receiver.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/model/model.hpp"
#include "firmware/panel/debounce.hpp"
#include "firmware/panel/status_led.hpp"
#include "firmware/request/request_cycle.hpp"
#include "firmware/request/state.hpp"
#include "firmware/settings/settings_keeper.hpp"
#include "firmware/time.hpp"
#include "firmware/watchdog/host_watchdog.hpp"
#include "firmware/watchdog/module_watchdog.hpp"

namespace ex9000 {

/// The device without its board. It touches no peripheral and reads no clock: bytes, edges, levels and the
/// time are arguments; outputs, LED, reply and memory job are asked for. An object lives from one reset to
/// the next.
///
/// Functions named `on_...` are for interrupts, which must not interrupt each other within one line:
/// `on_byte`, `on_silence` and `on_spoken` share a level, in which `on_silence` comes first if it waits too
/// (hal/one_shot_timer.hpp); `on_edge` and `on_tick` may have others. All else is for the main loop. Nothing
/// blocks.
class Module {
 public:
  /// `timing_at`: the times that hold on this line; not null.
  explicit constexpr Module(const Model& model, TimingAt timing_at = LineTiming::at)
      : timing_at_(timing_at), state_(model), keeper_(model), cycle_(state_, receiver_.tallies()) {}
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  /// Once, before interrupts are enabled. `input_levels`: bit n is channel n, 1 = +4 to +30 V; they are no
  /// edges.
  void start(std::uint16_t input_levels, Time now);

  // --- interrupts ---

  /// See Receiver::on_byte; only while `listening()`, and not while the own driver is on.
  Duration on_byte(std::uint8_t byte, ByteStatus status, Time now) {
    return receiver_.on_byte(byte, status, now);
  }
  /// See Receiver.
  Duration on_silence() { return receiver_.on_silence(); }
  void on_spoken(Time now) { receiver_.on_spoken(now); }
  /// See InputEdges::on_edge.
  void on_edge(unsigned channel, bool level) { edges_.on_edge(channel, level); }
  void on_tick() { module_watchdog_.tick_alive(); }
  /// Main loop too: a request is complete. If it is one of ASCII, its turn-around may not be over.
  [[nodiscard]] bool request_waits() const { return receiver_.queue().has_frame(); }
  /// Main loop: a host OK has come that no turn has counted yet. That may wait: it counts from its own time.
  [[nodiscard]] bool host_ok_waits() const { return receiver_.host_oks() != host_oks_seen_; }

  // --- main loop ---

  /// What people see and touch: at every tick, and when `idle_for` is over. `init_switch`: INIT* is asserted
  /// (tied to GND), not debounced.
  void poll_panel(bool init_switch, Time now);
  /// One turn: dispatches what the interrupts have collected, and does what is due.
  void step(Time now);
  /// How long nothing will happen by itself, that is, without an interrupt or a finished memory job; at most
  /// `at_most`. Zero: call `poll_panel` and `step` again at once.
  [[nodiscard]] Duration idle_for(Time now, Duration at_most) const;

  /// Levels to drive: bit n is channel n, 1 = energised. All 0 until the settings are read.
  [[nodiscard]] std::uint16_t outputs() const { return state_.outputs; }
  [[nodiscard]] bool led_lit() const { return led_.lit(); }
  /// Whether to feed the hardware watchdog. That it asks is the main loop's sign of life.
  bool feed_watchdog() { return module_watchdog_.main_loop_alive(); }

  /// Settings and INIT* are known: the line may be opened at `baud()`.
  [[nodiscard]] bool listening() const { return start_ == Start::Done; }
  /// Bits per second, from one reset to the next.
  [[nodiscard]] std::uint32_t baud() const { return baud_rate(state_.in_force.baud_code); }

  [[nodiscard]] bool needs_memory() const { return keeper_.busy(); }
  /// What to do with the memory, while it is needed; the same until `memory_done`.
  [[nodiscard]] MemoryJob memory_job() { return keeper_.job(); }
  void memory_done(bool ok) { keeper_.done(ok); }

  /// The reply to send now; empty: none, or not yet. It lives until `reply_sent`.
  Bytes take_reply(Time now) { return cycle_.take_reply(now); }
  /// The last stop bit has left and the driver is off.
  void reply_sent(Time now) { cycle_.reply_sent(now, turn_around()); }

  // --- for panels, logs and tests ---

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] StatusLed::Pattern led_pattern() const { return led_.pattern(); }
  /// When the host watchdog expires if nobody restarts it; disarmed if it does not run.
  [[nodiscard]] Deadline host_watchdog_expiry() const { return host_watchdog_.expiry(state_.settings); }
  /// It listens, and no request is waiting, being stored or being answered.
  [[nodiscard]] bool at_rest() const {
    return listening() && cycle_.phase() == RequestCycle::Phase::Idle && !receiver_.queue().has_frame();
  }
  /// What the last request came to.
  [[nodiscard]] const Outcome& outcome() const { return cycle_.outcome(); }
  /// Whether the settings in the memory could not be read at reset, and none have been stored since.
  [[nodiscard]] bool settings_unreadable() const { return keeper_.unreadable(); }

 private:
  /// From reset on.
  enum class Start : std::uint8_t {
    Loading,       ///< the memory is being read; outputs are off
    AwaitingInit,  ///< the settings are known, but not whether INIT* is asserted
    Done,          ///< the line is open
  };

  void start_up(Time now);
  void use_settings(Time now);
  void listen();
  void dispatch(Time now);
  void continue_store(Time now);
  void commit(Time now);
  void commit_settings();
  void commit_effects(Time now);
  void finish_request();
  void count_host_oks();
  void expire_host_watchdog(Time now);
  void collect_edges();
  [[nodiscard]] Duration turn_around() const;
  [[nodiscard]] Duration until_request(Time now) const;
  [[nodiscard]] bool step_is_due() const;
  [[nodiscard]] StatusLed::Pattern led_pattern_due() const;

  TimingAt timing_at_;
  Start start_ = Start::Loading;
  Deadline init_gives_up_;
  std::uint32_t host_oks_seen_ = 0;

  State state_;
  InputEdges edges_;
  Receiver receiver_;
  SettingsKeeper keeper_;
  RequestCycle cycle_;
  HostWatchdog host_watchdog_;
  ModuleWatchdog module_watchdog_;
  Debounce init_switch_;
  StatusLed led_;
};

}  // namespace ex9000
