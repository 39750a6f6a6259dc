// A module without its board.
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
#include "firmware/update/slot_job.hpp"
#include "firmware/watchdog/crash_count.hpp"
#include "firmware/watchdog/host_watchdog.hpp"
#include "firmware/watchdog/module_watchdog.hpp"

namespace ex9000 {

/// What a board knows at a reset.
struct Reset {
  ResetReason reason = ResetReason::Unknown;
  std::uint32_t serial_number = 0;  ///< of the board; 0: none
  std::uint32_t crashes = 0;        ///< see CrashCount::begin
  update::Origin origin;            ///< of the running image
};

/// Accesses no peripheral and reads no clock: the caller passes events, levels and the time, and reads
/// outputs, LED, reply and memory job. One object lives from one reset to the next. No function blocks. A
/// function that only forwards a call has the contract of what it calls.
class Module {
 public:
  explicit constexpr Module(const Model& model)
      : state_(model), keeper_(model), cycle_(state_, receiver_.tallies()) {}
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  /// Once, at reset, before any interrupt but the tick is enabled. `input_levels`: 1 = +4 to +30 V.
  void start(std::uint16_t input_levels, Time now, const Reset& reset = {});
  /// To be kept by the board from now on, through a reset by the watchdog or a fault.
  [[nodiscard]] std::uint32_t crashes() const { return crash_count_.to_keep(); }

  // --- interrupts ---

  /// Only after `listen`, and while the module's own driver is off.
  template <class Clock>
  Duration on_byte(std::uint8_t byte, ByteStatus status, const Clock& clock) {
    return receiver_.on_byte(byte, status, clock);
  }
  /// Then, if it `arbitrates`, call `on_window` too, and use the time that this returns.
  Duration on_silence(Time now) { return receiver_.on_silence(now); }
  /// A bus scan is under way, in which the module may still win.
  // not covered: kBuiltModbus is a constant
  [[nodiscard]] bool arbitrates() const { return kBuiltModbus && receiver_.arbitration().active(); }
  /// See Arbitration::on_time. Then send what `take_burst` returns.
  Duration on_window(Time now, bool line_low) {
    return receiver_.arbitration().on_time(now, line_low, !receiver_.queue().has_frame() && cycle_.at_rest());
  }
  Bytes take_burst() { return receiver_.arbitration().take_burst(); }
  /// When the last stop bit has been sent and the driver is off. Needs no `step`.
  void on_reply_sent(Time now) {
    receiver_.on_own_driver_off(now);
    cycle_.on_reply_sent(now);
  }
  void on_edge(unsigned channel, bool level, Time now) { edges_.on_edge(channel, level, now); }
  [[nodiscard]] bool edges_need_times() const { return edges_.needs_times(); }
  void on_tick() { module_watchdog_.tick_alive(); }
  /// A request, maybe still in its turn-around time, or a host OK waits for `step` (see HostOks).
  [[nodiscard]] bool frame_waits() const {
    return receiver_.queue().has_frame() || receiver_.host_oks().waiting();
  }

  // --- main loop ---

  /// Does all that is due: at the tick, at `next_deadline()`, when `frame_waits()`, after an edge if
  /// `edges_need_times()`, and after a memory job. `init_switch`: the raw level, true = INIT* tied to GND.
  void step(bool init_switch, Time now);
  /// When work becomes due without another event.
  [[nodiscard]] Deadline next_deadline() const;

  /// 1 = energised. All 0 until the settings are loaded.
  [[nodiscard]] std::uint16_t outputs() const { return state_.outputs; }
  [[nodiscard]] bool led_lit() const { return led_.lit(); }
  /// A reply that does not end jams the line: past its deadline, no feed until its end (wire.md section 6).
  bool feed_watchdog(Time now) {
    const bool jammed = cycle_.replying() && reply_deadline_.reached(now);
    return module_watchdog_.main_loop_alive() && !jammed && !receiver_.arbitration().jams(now);
  }

  /// The settings are loaded and the mode (INIT or normal) is selected: call `listen` with the times of the
  /// line at `baud()` with `format()`, and open the line.
  [[nodiscard]] bool listening() const { return start_ == Start::Done; }
  /// In bits per second. Rate and format do not change while `listening()`.
  [[nodiscard]] std::uint32_t baud() const { return baud_rate(state_.in_force.baud_code); }
  [[nodiscard]] LineFormat format() const { return line_format(state_.in_force.baud_code); }
  void listen(const LineTiming& timing);

  [[nodiscard]] bool needs_memory() const { return keeper_.busy(); }
  [[nodiscard]] MemoryJob memory_job() { return keeper_.job(); }
  void memory_done(const MemoryResult& result) { keeper_.done(result); }

  /// The same, for the image slots.
  // not covered: kBuiltUpdate is a constant
  [[nodiscard]] bool needs_slots() const { return kBuiltUpdate && state_.update.busy(); }
  [[nodiscard]] const update::SlotJob& slot_job() const { return state_.update.job(); }
  void slot_done() { state_.update.done(); }
  /// A new image has been activated. Reset the board when it `wants_reset`, which no event announces.
  [[nodiscard]] bool activating() const {
    // not covered: kBuiltUpdate is a constant
    return kBuiltUpdate && state_.update.state() == update::State::Activating;
  }
  [[nodiscard]] bool wants_reset() const { return activating() && cycle_.at_rest() && !keeper_.busy(); }

  /// The reply, once, when it may be sent; else empty. Valid until `on_reply_sent`.
  Bytes take_reply(Time now);

  // --- for panels, logs and tests ---

  [[nodiscard]] const State& state() const { return state_; }
  /// For a simulator, before `start`. `digits`: nn.nn in BCD.
  void pretend_version(std::uint16_t digits) { state_.version.pretend(digits); }
  /// For a simulator that has counted frames for others elsewhere.
  LineTallies& tallies() { return receiver_.tallies(); }
  [[nodiscard]] StatusLed::Pattern led_pattern() const { return led_.pattern(); }
  /// Disarmed if it is not running.
  [[nodiscard]] Deadline host_watchdog_expiry() const { return host_watchdog_.expiry(state_.settings); }
  /// Listening, and no request waits or is being processed, which takes until its reply has been sent.
  [[nodiscard]] bool at_rest() const {
    return listening() && cycle_.phase() == RequestCycle::Phase::Idle && !cycle_.replying() &&
           !receiver_.queue().has_frame();
  }
  [[nodiscard]] const Outcome& outcome() const { return cycle_.outcome(); }
  [[nodiscard]] bool settings_unreadable() const { return keeper_.unreadable(); }

 private:
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
  void continue_update(Time now);
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
  bool replied_ = false;     ///< at least once since the reset

  State state_;
  InputEdges edges_;
  Receiver receiver_;
  SettingsKeeper keeper_;
  RequestCycle cycle_;
  HostWatchdog host_watchdog_;
  ModuleWatchdog module_watchdog_;
  CrashCount crash_count_;
  Debounce init_switch_;
  StatusLed led_;
};

}  // namespace ex9000
