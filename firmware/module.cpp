#include "firmware/module.hpp"

#include <initializer_list>

namespace ex9000 {

namespace {

constexpr Duration kInitTimeout = milliseconds(50);  // wire.md D13
constexpr std::uint8_t kInitModeAddress = 0x00;

constexpr Duration sooner(Duration a, Duration b) { return b < a ? b : a; }

}  // namespace

void Module::start(std::uint16_t input_levels, Time now) {
  const auto levels = static_cast<std::uint16_t>(input_levels & state_.model().input_mask());
  edges_.begin(levels);
  state_.inputs.begin(levels);
  init_timeout_.set(now + kInitTimeout);
}

void Module::poll_panel(bool init_switch, Time now) {
  init_switch_.sample(init_switch, now);
  state_.init_asserted = init_switch_.level();
  led_.show(led_pattern_due(), now);
  collect_edges();
  cycle_.end_reply_gap(now);
}

StatusLed::Pattern Module::led_pattern_due() const {
  if (state_.settings.timeout_status) {
    return StatusLed::Pattern::HostTimeout;
  }
  return start_ != Start::Loading && settings_unreadable() ? StatusLed::Pattern::SettingsUnreadable
                                                           : StatusLed::Pattern::Steady;
}

void Module::step(Time now) {
  start_up(now);
  if (start_ == Start::Loading) {
    return;
  }
  count_host_oks();
  expire_host_watchdog(now);  // must run before the steps that drive outputs
  continue_store(now);
  if (cycle_.phase() == RequestCycle::Phase::Idle) {
    dispatch(now);
  }
  keeper_.poll(state_.settings, now);
}

// --- reset ---

void Module::start_up(Time now) {
  if (start_ == Start::Loading && !keeper_.loading()) {
    use_settings(now);
    start_ = Start::AwaitingInit;
  }
  // The module starts even if the INIT* switch never settles.
  if (start_ == Start::AwaitingInit && (init_switch_.known() || init_timeout_.reached(now))) {
    listen();
    start_ = Start::Done;
  }
}

void Module::use_settings(Time now) {
  state_.settings = keeper_.stored();
  state_.outputs =
      state_.settings.timeout_status ? state_.settings.safe_value : state_.settings.power_on_value;
  host_watchdog_.restart(now);
}

void Module::listen() {
  const Settings& settings = state_.settings;
  InForce& in_force = state_.in_force;
  in_force.init_mode = init_switch_.level();
  if (in_force.init_mode) {
    in_force.address = kInitModeAddress;
  } else {
    in_force.address = settings.address;
    in_force.baud_code = settings.baud_code;
    in_force.protocol = settings.protocol;
    in_force.checksum = (settings.format & kFormatChecksum) != 0;
  }
  state_.inputs.configure(in_force.protocol == Protocol::Ascii ? Inputs::CounterRange::FiveDigits
                                                               : Inputs::CounterRange::SixteenBits,
                          (settings.format & kFormatRisingEdge) != 0);
  init_timeout_.disarm();
  receiver_.listen({in_force.protocol, in_force.checksum, timing_at_(baud())});
  receiver_.answer_to(in_force.address);
}

// --- events from interrupts ---

void Module::collect_edges() {
  // Before `listen()`, it is not known whether the counters count rising or falling edges.
  if (listening()) {
    state_.inputs.collect(edges_, state_.model().inputs);
  }
}

void Module::count_host_oks() {
  if (!receiver_.host_oks().waiting()) {
    return;
  }
  const HostOks::Times times = receiver_.host_oks().take_in_main_loop();
  for (const Time received : {times.first, times.last}) {
    // A host OK counts from the time of its reception. It is too late if the watchdog expired before that.
    expire_host_watchdog(received);
    host_watchdog_.restart(received);
  }
}

void Module::expire_host_watchdog(Time now) {
  Settings& settings = state_.settings;
  if (!settings.watchdog_enabled || !host_watchdog_.expired(settings, now)) {
    return;
  }
  // The outputs must not wait for the memory. The keeper stores the new settings as soon as it can.
  settings.timeout_status = true;
  settings.watchdog_enabled = false;
  state_.outputs = settings.safe_value;
  keeper_.settings_changed();
  cycle_.keep_timeout_status();
}

// --- requests ---

/// Judges the waiting frame when its turn-around time is over.
void Module::dispatch(Time now) {
  if (!receiver_.queue().has_frame() || !(until_request(now) == Duration())) {
    return;
  }
  collect_edges();
  const Outcome& outcome = cycle_.judge(receiver_.queue().waiting().bytes());
  receiver_.queue().drop_in_main_loop();
  if (outcome.changes_settings()) {
    continue_store(now);
  } else {
    commit(now);
  }
}

/// Returns the time until the waiting frame may be judged. This is 0 for a Modbus frame, which is complete
/// only after its silence. A DCON frame is complete when its turn-around time begins.
Duration Module::until_request(Time now) const {
  if (state_.speaks_modbus()) {
    return {};
  }
  // A deadline is necessary because the frame may be newer than `now`; `now.since()` would then wrap.
  Deadline over;
  over.set(receiver_.queue().waiting().received + turn_around());
  return over.remaining(now);
}

Duration Module::turn_around() const {
  return state_.speaks_modbus() ? receiver_.timing().rtu_silence : receiver_.timing().dcon_turn_around;
}

void Module::continue_store(Time now) {
  const bool awaiting_store = cycle_.phase() == RequestCycle::Phase::AwaitingStore;
  if (keeper_.busy()) {
    if (awaiting_store) {
      keeper_.let_command_through();
    }
    return;
  }
  if (awaiting_store) {
    const Settings changed = cycle_.outcome().change().applied_to(state_.settings);
    if (changed == keeper_.stored() && keeper_.certain()) {
      commit(now);  // a command that changes nothing writes nothing
    } else {
      keeper_.save(changed, now);
      cycle_.store_begun();
    }
  } else if (cycle_.phase() == RequestCycle::Phase::Storing) {
    if (keeper_.saved()) {
      commit(now);
    } else {
      cycle_.refuse_store();
      finish_request();
    }
  }
}

/// Carries out a request that has been judged and whose settings are stored.
void Module::commit(Time now) {
  if (cycle_.outcome().changes_settings()) {
    commit_settings();
  }
  if (!state_.outputs_blocked()) {
    const Drive drive = cycle_.outcome().outputs_to_drive();
    state_.outputs = static_cast<std::uint16_t>((state_.outputs & ~drive.mask) | (drive.value & drive.mask));
  }
  commit_effects(now);
  finish_request();
}

void Module::commit_settings() {
  state_.settings = cycle_.outcome().change().applied_to(state_.settings);
  if (state_.settings.timeout_status) {
    state_.outputs = state_.settings.safe_value;  // the request may have changed it (wire.md D6)
  }
}

void Module::commit_effects(Time now) {
  const Outcome& outcome = cycle_.outcome();
  if (!outcome.has_effects()) {
    return;
  }
  if (outcome.asks_for(Effect::RestartHostWatchdog)) {
    host_watchdog_.restart(now);
  }
  if (outcome.asks_for(Effect::TakeAddress)) {
    state_.in_force.address = state_.settings.address;
    receiver_.answer_to(state_.settings.address);
  }
  if (outcome.asks_for(Effect::TakeCountingEdge)) {
    collect_edges();  // the edges until now count under the previous setting
    state_.inputs.count_rising_edges((state_.settings.format & kFormatRisingEdge) != 0);
  }
  if (outcome.asks_for(Effect::TakeSample)) {
    state_.sample = {true, false, state_.outputs, state_.inputs.levels()};
  }
  if (outcome.asks_for(Effect::MarkSampleRead)) {
    state_.sample.read = true;
  }
  if (outcome.asks_for(Effect::ClearResetStatus)) {
    state_.reset_status = false;
  }
  if (outcome.asks_for(Effect::ClearLatches)) {
    state_.inputs.clear_latches();
  }
  if (outcome.asks_for(Effect::ClearCounters)) {
    state_.inputs.clear_counters(outcome.counters_to_clear);
  }
  if (outcome.asks_for(Effect::ClearDiagnostics)) {
    receiver_.tallies().clear();
    state_.diagnostics = Diagnostics();
  }
}

void Module::finish_request() {
  const bool refused = cycle_.outcome().refusal != Refusal::None;
  Diagnostics& diagnostics = state_.diagnostics;
  if (!cycle_.finish()) {
    ++diagnostics.no_responses;
  } else if (refused) {
    ++diagnostics.exceptions;
  }
}

// --- sleep ---

/// Returns whether something has happened that `step` or `poll_panel` has not processed yet.
bool Module::step_is_due() const {
  const bool memory_is_done = !keeper_.busy() && (start_ == Start::Loading || keeper_.has_work() ||
                                                  cycle_.phase() == RequestCycle::Phase::Storing);
  return memory_is_done || host_ok_waits() || led_.pattern() != led_pattern_due();
}

Duration Module::idle_for(Time now, Duration at_most) const {
  if (step_is_due()) {
    return {};
  }
  Duration idle = at_most;
  const auto consider = [&idle, now](const Deadline& deadline) {
    if (deadline.armed()) {
      idle = sooner(idle, deadline.remaining(now));
    }
  };
  consider(init_switch_.next_sample());
  consider(led_.next_change());
  if (start_ == Start::Loading) {
    return idle;
  }
  consider(init_timeout_);
  consider(host_watchdog_expiry());
  if (!keeper_.busy()) {
    consider(keeper_.retry());
  }
  if (cycle_.phase() == RequestCycle::Phase::Idle && receiver_.queue().has_frame()) {
    idle = sooner(idle, until_request(now));
  }
  if (cycle_.phase() == RequestCycle::Phase::ReplyReady) {
    idle = sooner(idle, cycle_.until_reply(now));
  }
  return idle;
}

}  // namespace ex9000
