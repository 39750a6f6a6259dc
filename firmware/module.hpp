// A module without its board: its parts and how they are connected.
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
#include "firmware/reset_reason.hpp"
#include "firmware/settings/settings_keeper.hpp"
#include "firmware/time.hpp"
#include "firmware/watchdog/host_watchdog.hpp"
#include "firmware/watchdog/module_watchdog.hpp"

namespace ex9000 {

/// A module without its board. It accesses no peripheral and reads no clock. The caller passes events, levels
/// and the time as arguments, and reads results such as the outputs, the LED, the reply and the memory job.
/// An object exists from one reset to the next.
///
/// Interrupts call the functions above `step`. These interrupts must not interrupt each other, so they share
/// one preemption priority. If `on_byte` and `on_silence` are both pending, `on_silence` must run first
/// (hal/one_shot_timer.hpp). The main loop calls the other functions. No function blocks.
class Module {
 public:
  explicit constexpr Module(const Model& model)
      : state_(model), keeper_(model), cycle_(state_, receiver_.tallies()) {}
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  /// Starts the module at a reset. Call this once, before the interrupts that call `on_...` are enabled.
  /// Only the tick interrupt may be enabled earlier. `input_levels`: bit n is channel n, 1 = +4 to +30 V.
  /// These levels do not count as edges. `reason`: why the module was reset.
  void start(std::uint16_t input_levels, Time now, ResetReason reason = ResetReason::Unknown);

  // --- interrupts ---

  /// See Receiver::on_byte. Call this only after `listen` and while the module's own driver is off.
  template <class Clock>
  Duration on_byte(std::uint8_t byte, ByteStatus status, const Clock& clock) {
    return receiver_.on_byte(byte, status, clock);
  }
  /// See Receiver::on_silence.
  Duration on_silence(Time now) { return receiver_.on_silence(now); }
  /// Processes the end of a reply, when its last stop bit has been sent and the driver is off. The main loop
  /// need not call `step` for this.
  void on_reply_sent(Time now) {
    receiver_.on_own_driver_off(now);
    cycle_.on_reply_sent(now);
  }
  /// See InputEdges::on_edge.
  void on_edge(unsigned channel, bool level, Time now) { edges_.on_edge(channel, level, now); }
  /// See InputEdges::needs_times.
  [[nodiscard]] bool edges_need_times() const { return edges_.needs_times(); }
  /// See ModuleWatchdog::tick_alive.
  void on_tick() { module_watchdog_.tick_alive(); }
  /// Returns whether a request or a host OK is waiting, so that the main loop must call `step` (see HostOks).
  /// The turn-around time of an ASCII request may still be running.
  [[nodiscard]] bool frame_waits() const {
    return receiver_.queue().has_frame() || receiver_.host_oks().waiting();
  }

  // --- main loop ---

  /// Does all work that is due at `now`. Call this at the tick, at `next_deadline()`, when `frame_waits()`,
  /// after an edge if `edges_need_times()` is true, and after a memory job. `init_switch`: the present level
  /// of INIT*, true = asserted (tied to GND). The module debounces it.
  void step(bool init_switch, Time now);
  /// The earliest of the times at which work becomes due without another event.
  [[nodiscard]] Deadline next_deadline() const;

  /// Returns the levels to drive: bit n is channel n, 1 = energised. All are 0 until the settings are loaded.
  [[nodiscard]] std::uint16_t outputs() const { return state_.outputs; }
  [[nodiscard]] bool led_lit() const { return led_.lit(); }
  /// Returns whether to feed the hardware watchdog: see ModuleWatchdog::main_loop_alive. A reply that does
  /// not end jams the line, so past its deadline there is no feed until its end (wire.md section 6).
  bool feed_watchdog(Time now) {
    return module_watchdog_.main_loop_alive() && !(cycle_.replying() && reply_deadline_.reached(now));
  }

  /// Returns whether the start is complete: the settings are loaded, and the module has selected INIT mode or
  /// normal operation. Then call `listen` with the times of the line at `baud()` with `format()`, and open
  /// the line.
  [[nodiscard]] bool listening() const { return start_ == Start::Done; }
  /// Return the baud rate in bits per second and the line format. They do not change while `listening()`.
  [[nodiscard]] std::uint32_t baud() const { return baud_rate(state_.in_force.baud_code); }
  [[nodiscard]] LineFormat format() const { return line_format(state_.in_force.baud_code); }
  void listen(const LineTiming& timing);

  /// See SettingsKeeper::busy.
  [[nodiscard]] bool needs_memory() const { return keeper_.busy(); }
  /// See SettingsKeeper::job and SettingsKeeper::done.
  [[nodiscard]] MemoryJob memory_job() { return keeper_.job(); }
  void memory_done(const MemoryResult& result) { keeper_.done(result); }

  /// Returns the reply if it may be sent now. Returns each reply only once. The result is empty if no reply
  /// is ready, or if it is too early to send the reply. The bytes are valid until `on_reply_sent`.
  Bytes take_reply(Time now);

  // --- for panels, logs and tests ---

  [[nodiscard]] const State& state() const { return state_; }
  /// For a simulator that has counted frames for others elsewhere.
  LineTallies& tallies() { return receiver_.tallies(); }
  [[nodiscard]] StatusLed::Pattern led_pattern() const { return led_.pattern(); }
  /// Returns when the host watchdog expires unless it is restarted; disarmed if it is not running.
  [[nodiscard]] Deadline host_watchdog_expiry() const { return host_watchdog_.expiry(state_.settings); }
  /// Returns whether the module is listening, and no request is waiting or being processed. The processing
  /// ends when the reply has been sent.
  [[nodiscard]] bool at_rest() const {
    return listening() && cycle_.phase() == RequestCycle::Phase::Idle && !cycle_.replying() &&
           !receiver_.queue().has_frame();
  }
  /// See RequestCycle::outcome.
  [[nodiscard]] const Outcome& outcome() const { return cycle_.outcome(); }
  /// Returns whether the settings in the memory could not be read at reset, and no settings have been stored
  /// since. Valid when loading has ended.
  [[nodiscard]] bool settings_unreadable() const { return keeper_.unreadable(); }

 private:
  /// The phases of the start after a reset.
  enum class Start : std::uint8_t {
    Loading,       ///< the memory is being read; outputs are off
    AwaitingInit,  ///< the settings are known; the INIT* switch has not settled yet
    Done,          ///< the mode is selected; the line can be opened
  };

  void start_up(Time now);
  void use_settings(Time now);
  void apply(const Settings& settings, Time now);
  void apply_to_inputs(const Settings& settings, Time now);
  void select_mode();
  void dispatch(Time now);
  void continue_store(Time now);
  void commit(Time now);
  void drive_outputs(Time now);
  void end_timed_outputs(Time now);
  void commit_effects(Time now);
  void finish_request();
  void count_host_oks();
  void update_statistics(Time now);
  void expire_host_watchdog(Time now);
  void collect_edges(Time now);
  [[nodiscard]] Duration turn_around() const;
  [[nodiscard]] Deadline request_due() const;
  [[nodiscard]] StatusLed::Pattern led_pattern_due() const;

  Start start_ = Start::Loading;
  Deadline init_timeout_;    ///< armed until the module no longer waits for INIT*
  Deadline reply_deadline_;  ///< latest end of the last reply
  Time second_began_;        ///< when the current second of the uptime began

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
