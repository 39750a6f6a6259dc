#include "firmware/module.hpp"

#include <initializer_list>

#include "firmware/expect.hpp"

namespace ex9000 {

namespace {

constexpr Duration kInitTimeout = milliseconds(50);  // wire.md D13
constexpr std::uint8_t kInitModeAddress = 0x00;
constexpr Duration kClockResolution(1);  // an event may be this much later than its recorded time

}  // namespace

void Module::start(std::uint16_t input_levels, Time now, const Reset& reset) {
  const auto levels = static_cast<std::uint16_t>(input_levels & state_.model().input_mask());
  edges_.begin(levels);
  edges_.time_edges(true);  // the settings, which are not known yet, may contain filters
  state_.inputs.begin(levels);
  init_timeout_.set(now + kInitTimeout);
  second_began_ = now;
  state_.statistics.reset_reason = reset.reason;
  state_.board_serial_number = reset.serial_number;
  crash_count_.begin(reset.reason, reset.crashes);
  // not covered: kBuiltUpdate is a constant
  if (kBuiltUpdate && reset.origin.heads[0].size != 0) {
    state_.update.start(reset.origin, state_.model());
  }
}

StatusLed::Pattern Module::led_pattern_due() const {
  if (state_.settings.timeout_status) {
    return StatusLed::Pattern::HostTimeout;
  }
  return settings_unreadable() ? StatusLed::Pattern::SettingsUnreadable : StatusLed::Pattern::Steady;
}

void Module::step(bool init_switch, Time now) {
  init_switch_.sample(init_switch, now);
  state_.init_asserted = init_switch_.level();
  update_statistics(now);
  if (start_ != Start::Done) {
    start_up(now);
  }
  if (start_ == Start::Loading) {
    return;
  }
  collect_edges(now);
  count_host_oks();
  expire_host_watchdog(now);  // must run before the steps that drive outputs
  end_timed_outputs(now);
  cycle_.poll(now);
  if (cycle_.stores()) {
    continue_store(now);
  }
  dispatch(now);
  if (kBuiltUpdate) {
    continue_update(now);
  }
  keeper_.poll(state_.settings, now);
  led_.show(led_pattern_due(), now);
  EX9000_EXPECT((state_.outputs & ~state_.model().output_mask()) == 0);
  EX9000_EXPECT(!state_.settings.timeout_status || state_.outputs == state_.settings.safe_value);
}

// --- reset ---

void Module::start_up(Time now) {
  if (start_ == Start::Loading && !keeper_.loading()) {
    use_settings(now);
    start_ = Start::AwaitingInit;
    collect_edges(now);  // a filter may already be waiting for the end of its time
  }
  // Start even if the INIT* switch never settles.
  if (init_switch_.known() || init_timeout_.reached(now)) {
    init_timeout_.disarm();
  }
  if (start_ == Start::AwaitingInit && !init_timeout_.armed()) {
    select_mode();
    start_ = Start::Done;
  }
}

void Module::use_settings(Time now) {
  const Settings& stored = keeper_.stored();
  state_.statistics.settings_source = keeper_.source();
  state_.outputs = crash_count_.looping() ? stored.safe_value : stored.power_on_value;
  state_.inputs.count_rising_edges((stored.format & kFormatRisingEdge) != 0);
  apply(stored, now);
  host_watchdog_.restart(now);
}

/// At reset and after a command's store; not those that wait for the next reset or need an Effect.
void Module::apply(const Settings& settings, Time now) {
  EX9000_EXPECT(settings.possible_for(state_.model()));
  if (state_.model().has_inputs()) {
    apply_to_inputs(settings, now);
  }
  state_.settings = settings;
  receiver_.restart_by_requests(settings.fed_by_requests);
  receiver_.answer_to_number(state_.serial_number());
  if (settings.timeout_status) {
    state_.outputs = settings.safe_value;  // this value may be new (wire.md D6)
  }
}

/// Edges until now count with the previous inversion and filters. A changed level that does not count yet
/// does so when the new filter time has passed since its channel's last edge.
void Module::apply_to_inputs(const Settings& settings, Time now) {
  edges_.time_edges(true);  // a new filter uses the time of each edge that the next line does not collect
  collect_edges(now);
  state_.inputs.invert(settings.inverted_inputs);
  edges_.time_edges(settings.input_filters.any());  // first, because the filters use the times of edges
  state_.inputs.use_filters(settings.input_filters, now);
  collect_edges(now);
}

void Module::select_mode() {
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
  state_.inputs.use_range(in_force.protocol == Protocol::Ascii ? Inputs::CounterRange::FiveDigits
                                                               : Inputs::CounterRange::SixteenBits);
}

void Module::listen(const LineTiming& timing) {
  EX9000_EXPECT(listening());
  receiver_.listen({state_.in_force.protocol, state_.in_force.checksum, timing});
  receiver_.answer_to(state_.in_force.address);
  cycle_.keep_apart(turn_around());
}

// --- events from interrupts ---

void Module::collect_edges(Time now) {
  // Before loading ends, the inputs lack the counting edge, inversion and filters.
  if (state_.model().has_inputs() && start_ != Start::Loading) {
    state_.inputs.collect(edges_, state_.model().inputs, now);
  }
}

void Module::count_host_oks() {
  if (!receiver_.host_oks().waiting()) {
    return;
  }
  const HostOks::Times times = receiver_.host_oks().take_in_main_loop();
  for (const Time received : {times.first, times.last}) {
    // It counts from its recorded time. If the watchdog had expired by then, the host OK is too late.
    expire_host_watchdog(received);
    host_watchdog_.restart(received);
  }
}

void Module::update_statistics(Time now) {
  constexpr Duration kSecond = milliseconds(1000);
  while (!(now.since(second_began_) < kSecond)) {
    second_began_ = second_began_ + kSecond;
    ++state_.statistics.seconds_up;
    crash_count_.lived(state_.statistics.seconds_up);
    // not covered: kBuiltUpdate is a constant
    if (kBuiltUpdate && replied_ && state_.statistics.seconds_up % kProof == 0) {
      state_.update.proved();
    }
  }
  state_.statistics.stores = keeper_.saves();
}

void Module::expire_host_watchdog(Time now) {
  Settings& settings = state_.settings;
  if (!settings.watchdog_enabled || !host_watchdog_.expired(settings, now)) {
    return;
  }
  // The outputs must not wait for the memory: the keeper stores when it can.
  settings.timeout_status = true;
  settings.watchdog_enabled = false;
  state_.outputs = settings.safe_value;
  state_.output_timers.stop(state_.model().output_mask());
  count_saturating(state_.statistics.timeouts);
  keeper_.settings_changed();
  cycle_.keep_timeout_status();
}

// --- requests ---

void Module::dispatch(Time now) {
  if (!receiver_.queue().has_frame() || !request_due().reached(now)) {
    return;
  }
  const Frame& request = receiver_.queue().waiting();
  const Outcome& outcome = cycle_.judge(request, now);
  if (!state_.in_force.init_mode && state_.settings.response_delay != 0) {
    cycle_.hold_reply_until(request.received + receiver_.timing().rest_of_stop_bit +
                            milliseconds(state_.settings.response_delay) + kClockResolution);
  }
  if (outcome.asked_of_update().ask != update::Ask::Nothing) {
    state_.update.accept(outcome.asked_of_update(), now);  // copies the data from the frame
  }
  receiver_.queue().drop_in_main_loop();
  if (outcome.changes_settings()) {
    continue_store(now);
  } else if (cycle_.phase() == RequestCycle::Phase::Judged) {
    commit(now);
  }
}

/// Also without a request.
void Module::continue_update(Time now) {
  update::Update& update = state_.update;
  update.poll(now);
  if (cycle_.phase() != RequestCycle::Phase::Updating || !update.answered()) {
    return;
  }
  if (update.answer() == Refusal::None) {
    commit(now);
  } else {
    cycle_.refuse(update.answer());
    finish_request();
  }
}

/// Only if a frame is waiting; disarmed while another is being processed. A Modbus frame is complete after
/// its silence (but: wire.md D9), a DCON frame when its turn-around time begins.
Deadline Module::request_due() const {
  if (!cycle_.free()) {
    return {};
  }
  const Time received = receiver_.queue().waiting().received;
  return Deadline(state_.speaks_modbus() ? received : received + turn_around());
}

Duration Module::turn_around() const {
  return state_.speaks_modbus() ? receiver_.timing().rtu_silence : receiver_.timing().dcon_turn_around;
}

/// Only while `cycle_.stores()`.
void Module::continue_store(Time now) {
  if (keeper_.busy()) {
    return;
  }
  if (cycle_.phase() == RequestCycle::Phase::AwaitingStore) {
    const Settings changed = cycle_.outcome().change().applied_to(state_.settings);
    if (changed == keeper_.stored() && keeper_.certain()) {
      commit(now);  // a reset now would load these settings, so nothing is written
    } else {
      keeper_.save(changed, now);
      cycle_.store_begun();
    }
  } else if (keeper_.saved()) {
    commit(now);
  } else {
    cycle_.refuse(Refusal::StoreFailed);
    finish_request();
  }
}

Bytes Module::take_reply(Time now) {
  const Bytes reply = cycle_.take_reply(now);
  if (reply.size != 0) {
    const auto characters = static_cast<std::uint32_t>(reply.size);
    const Duration length(characters * receiver_.timing().character.microseconds());
    reply_deadline_.set(now + length + kReplyMargin);
  }
  return reply;
}

/// Carries out a judged request. Settings that it changes must be stored already.
void Module::commit(Time now) {
  if (cycle_.outcome().changes_settings()) {
    apply(cycle_.outcome().change().applied_to(state_.settings), now);
  }
  if (cycle_.outcome().drives_outputs() && !state_.outputs_blocked()) {
    drive_outputs(now);
  }
  commit_effects(now);
  finish_request();
}

void Module::drive_outputs(Time now) {
  const BitWrite drive = cycle_.outcome().outputs_to_drive();
  state_.outputs = drive.applied_to(state_.outputs);
  state_.output_timers.stop(drive.mask);

  const TimedDrive& timed = cycle_.outcome().timed_outputs_to_drive();
  state_.outputs = static_cast<std::uint16_t>(state_.outputs & ~timed.mask);
  state_.output_timers.stop(timed.mask);
  for (unsigned channel = 0; timed.mask >> channel != 0; ++channel) {
    if ((timed.mask >> channel & 1U) != 0 && timed.units[channel] != 0) {
      state_.outputs = static_cast<std::uint16_t>(state_.outputs | 1U << channel);
      state_.output_timers.start(channel, timed.units[channel], now);
    }
  }
}

void Module::end_timed_outputs(Time now) {
  state_.outputs = static_cast<std::uint16_t>(state_.outputs & ~state_.output_timers.expire(now));
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
  if (outcome.asks_for(Effect::ClearTimeoutCount)) {
    state_.statistics.timeouts = 0;
  }
  if (outcome.asks_for(Effect::ClearDiagnostics)) {
    receiver_.tallies().clear();
    state_.diagnostics = Diagnostics();
  }
}

void Module::finish_request() {
  const Refusal refusal = cycle_.outcome().refusal;
  // In ASCII, only `?` counts as an exception; the reply for blocked outputs begins with `!`.
  const bool refused =
      refusal != Refusal::None && (state_.speaks_modbus() || refusal != Refusal::OutputsBlocked);
  Diagnostics& diagnostics = state_.diagnostics;
  if (!cycle_.finish()) {
    ++diagnostics.no_responses;
    return;
  }
  replied_ = true;
  if (refused) {
    ++diagnostics.exceptions;
  }
}

// --- sleep ---

Deadline Module::next_deadline() const {
  Deadline next = init_switch_.next_sample();
  next.advance_to(init_timeout_);
  next.advance_to(led_.next_change());
  next.advance_to(host_watchdog_expiry());
  next.advance_to(keeper_.retry());
  if (receiver_.queue().has_frame()) {
    next.advance_to(request_due());
  }
  next.advance_to(cycle_.reply_due());
  if (kBuiltUpdate) {
    next.advance_to(state_.update.latest_answer());
  }
  next.advance_to(state_.inputs.next_settling());
  next.advance_to(state_.output_timers.next_end());
  return next;
}

}  // namespace ex9000
