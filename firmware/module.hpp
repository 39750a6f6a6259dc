// One module: what interrupts tell it, what the main loop does, and what it wants of the board.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/channels/inputs.hpp"
#include "firmware/line/crossing.hpp"
#include "firmware/line/receiver.hpp"
#include "firmware/model/model.hpp"
#include "firmware/panel/debounce.hpp"
#include "firmware/panel/status_led.hpp"
#include "firmware/request/exchange.hpp"
#include "firmware/settings/store.hpp"
#include "firmware/time.hpp"
#include "firmware/watchdog/host_watchdog.hpp"
#include "firmware/watchdog/module_watchdog.hpp"

namespace ex9000 {

/// The device without its board. It touches no peripheral and reads no clock: bytes, edges, levels and the
/// time come in as arguments; outputs, LED, reply and memory job are asked for. An object lives from one
/// reset to the next.
///
/// Functions named `on_...` are for interrupts, which must not interrupt each other within one line:
/// `on_byte` and `on_silence` share a level, `on_edge` and `on_tick` may have others. All else is for the
/// main loop. Nothing blocks.
class Module {
 public:
  explicit constexpr Module(const Model& model) : store_(model), exchange_(model) {}
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  /// Once, before anything else. `input_levels`: bit n is channel n, 1 = +4 to +30 V. `timing_at` is asked
  /// once, in the main loop, when the rate is known; not null.
  void begin(std::uint16_t input_levels, Time now, TimingAt timing_at = LineTiming::at);

  // --- interrupts ---

  /// See Receiver::on_byte; only while `listening()`, and not while the own driver is on.
  Duration on_byte(std::uint8_t byte, ByteStatus status, Time now) {
    return receiver_.on_byte(byte, status, now);
  }
  /// See Receiver.
  Duration on_silence() { return receiver_.on_silence(); }
  void on_spoken() { receiver_.on_spoken(); }
  /// See InputEdges::on_edge.
  void on_edge(unsigned channel, bool level) { edges_.on_edge(channel, level); }
  void on_tick() { module_watchdog_.tick_alive(); }

  // --- main loop ---

  /// What people see and touch, often enough for them: every few milliseconds. `init_switch`: INIT* is
  /// asserted (tied to GND), not debounced.
  void look_around(bool init_switch, Time now);
  /// One turn: what the interrupts have gathered, what the clock says, what the memory has done.
  void step(Time now);
  /// Interrupts too: counts up with every frame that may be for this module, so that `step` can judge it
  /// while the silence behind it lasts; and with every host OK, so that each is heeded before the next can
  /// come.
  [[nodiscard, gnu::always_inline]] std::uint32_t line_events() const {
    return receiver_.queue().announced() + receiver_.host_oks();
  }
  /// Interrupts too: a request is complete, so `step` can act upon it when the silence is over.
  [[nodiscard]] bool request_waits() const { return receiver_.queue().has_frame(); }
  /// How long nothing will happen by itself; zero: step again at once; nothing: until an interrupt or a
  /// finished job.
  [[nodiscard]] std::optional<Duration> idle_for(Time now) const;

  /// Levels to drive: bit n is channel n, 1 = energised. All 0 until the settings are read.
  [[nodiscard]] std::uint16_t outputs() const { return state().outputs; }
  [[nodiscard]] bool led_lit() const { return led_.lit(); }
  /// Whether to feed the hardware watchdog; asks once a turn.
  bool feed_watchdog() { return module_watchdog_.main_loop_alive(); }

  /// Settings and INIT* are known: the line may be opened at `baud()`.
  [[nodiscard]] bool listening() const { return phase_ != Phase::Booting; }
  /// Bits per second, from one reset to the next.
  [[nodiscard]] std::uint32_t baud() const { return baud_rate(state().in_force.baud_code); }

  [[nodiscard]] bool wants_memory() const { return store_.busy(); }
  /// What to do with the memory, where it is wanted; the same until `memory_done`.
  [[nodiscard]] MemoryJob memory_job() { return store_.job(); }
  void memory_started() { store_.started(); }
  void memory_done(bool ok) {
    store_.done(ok);
    judgement_stands_ = false;  // what is stored may be something else now
  }

  /// The reply to send now; empty: none, or not yet. It lives until `reply_sent`.
  Bytes take_reply(Time now);
  /// The last stop bit has left and the driver is off.
  void reply_sent(Time now);

  // --- for those who look on: panels, logs, tests ---

  [[nodiscard]] const State& state() const { return exchange_.state(); }
  [[nodiscard]] StatusLed::Pattern led_pattern() const { return led_.pattern(); }
  /// When the host watchdog expires if nobody restarts it; disarmed where it does not run.
  [[nodiscard]] Deadline host_watchdog_expiry() const { return host_watchdog_.expiry(state().settings); }
  /// It listens, and no request is waiting, being stored or being answered.
  [[nodiscard]] bool at_rest() const { return phase_ == Phase::Idle && !receiver_.queue().has_frame(); }
  /// What the last request came to.
  [[nodiscard]] const Outcome& outcome() const { return exchange_.outcome; }
  /// Whether the settings in the memory could not be read at reset, and none have been stored since.
  [[nodiscard]] bool settings_unreadable() const {
    return store_.found() == SettingsStore::Found::Unreadable;
  }

 private:
  enum class Phase : std::uint8_t {
    Booting,     ///< reading settings, waiting for INIT* to settle
    Idle,        ///< the next request may be judged and acted upon
    MustStore,   ///< judged; the memory is busy with leftovers
    Storing,     ///< judged; the memory is taking the change
    ReplyReady,  ///< done; the reply waits for its moment
    Replying,    ///< the driver is on
  };

  [[nodiscard]] StatusLed::Pattern led_pattern_due() const;
  void come_up(Time now);
  void use_settings(Time now);
  void start_listening();
  [[nodiscard]] bool init_is_known(Time now) const;
  void collect_edges();
  [[nodiscard]] bool ascii() const { return !kBuiltModbus || state().in_force.protocol == Protocol::Ascii; }
  void heed_host_ok();
  void expire_host_watchdog(Time now);
  void go_on_storing(Time now);
  void store_leftovers(Time now);
  void have_effects(Time now);
  void attend(Time now);
  void judge(Bytes frame, bool complete);
  [[nodiscard]] Duration silence_left(Time now) const;
  void prepare_store();
  void act(Time now);
  void carry_out(Time now);
  void answered();
  void refuse_store();
  void count_exception();

  Phase phase_ = Phase::Booting;
  TimingAt timing_at_ = nullptr;
  bool settings_known_ = false;
  bool storing_leftovers_ = false;     ///< the store that is under way was not asked for by a command
  bool leftovers_ = false;             ///< the settings may not be what is stored, or the store is doubtful
  bool expired_since_judged_ = false;  ///< the host watchdog has expired while a command waits for its store
  bool judgement_stands_ = false;      ///< nothing that `judge` goes by has changed since
  Deadline leftovers_retry_;
  Deadline init_gives_up_;
  std::uint32_t judged_ = 0;  ///< the frame in `exchange_`, by its number
  std::uint32_t host_oks_heeded_ = 0;
  std::uint32_t edges_collected_ = 0;
  Duration turn_around_;  ///< silence before a reply: behind the request, and behind the reply before it
  Deadline line_quiet_;   ///< after the last reply

  InputEdges edges_;
  ModuleWatchdog module_watchdog_;
  HostWatchdog host_watchdog_;
  StatusLed led_;
  Debounce init_switch_;
  SettingsStore store_;
  Settings changed_;     ///< what the request wants the settings to be
  bool stores_ = false;  ///< and that is not what is stored
  Exchange exchange_;
  Receiver receiver_;
};

}  // namespace ex9000
