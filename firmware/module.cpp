#include "firmware/module.hpp"

#include "firmware/dcon/dcon.hpp"
#include "firmware/modbus/modbus.hpp"

namespace ex9000 {

namespace {

constexpr Duration kStoreRetry = milliseconds(1000);  // D15
constexpr Duration kInitGivesUp = milliseconds(50);   // D13

constexpr std::uint8_t kInitModeAddress = 0x00;

}  // namespace

void Module::begin(std::uint16_t input_levels, Time now, TimingAt timing_at) {
  timing_at_ = timing_at;
  exchange_.tallies_ = &receiver_.tallies();
  exchange_.state_.in_force.baud_code = kFactoryBaudCode;
  exchange_.state_.reset_status = true;
  const auto levels = static_cast<std::uint16_t>(input_levels & state().model().input_mask());
  edges_.begin(levels);
  exchange_.state_.inputs.begin(levels);
  store_.begin_loading();
  init_gives_up_.set(now + kInitGivesUp);
  led_.show(StatusLed::Pattern::Steady, now);
}

void Module::look_around(bool init_switch, Time now) {
  init_switch_.sample(init_switch, now);
  if (exchange_.state_.init_asserted != init_switch_.level()) {
    exchange_.state_.init_asserted = init_switch_.level();
    judgement_stands_ = false;
  }
  led_.show(led_pattern_due(), now);
  collect_edges();
  if (line_quiet_.reached(now)) {
    line_quiet_.disarm();
  }
}

StatusLed::Pattern Module::led_pattern_due() const {
  if (state().settings.timeout_status) {
    return StatusLed::Pattern::HostTimeout;
  }
  return settings_known_ && settings_unreadable() ? StatusLed::Pattern::SettingsUnreadable
                                                  : StatusLed::Pattern::Steady;
}

void Module::step(Time now) {
  if (phase_ == Phase::Booting) {
    come_up(now);
  }
  if (!settings_known_) {
    return;
  }
  heed_host_ok();
  expire_host_watchdog(now);  // before anything that drives outputs
  if (storing_leftovers_ || phase_ == Phase::Storing) {
    go_on_storing(now);
  }
  if (phase_ == Phase::Idle) {
    attend(now);
  }
  if (leftovers_) {
    store_leftovers(now);
  }
}

// --- reset ---

/// A switch that never stands still is no reason not to come up.
bool Module::init_is_known(Time now) const { return init_switch_.known() || init_gives_up_.reached(now); }

void Module::come_up(Time now) {
  if (!settings_known_ && !store_.loading()) {
    use_settings(now);
  }
  if (settings_known_ && init_is_known(now)) {
    start_listening();
  }
}

void Module::use_settings(Time now) {
  settings_known_ = true;
  State& state = exchange_.state_;
  state.settings = store_.stored();
  state.outputs = state.settings.timeout_status ? state.settings.safe_value : state.settings.power_on_value;
  host_watchdog_.restart(now);
}

void Module::start_listening() {
  State& state = exchange_.state_;
  const Settings& settings = state.settings;
  InForce& in_force = state.in_force;
  in_force.init_mode = init_switch_.level();
  if (in_force.init_mode) {
    in_force.address = kInitModeAddress;
    in_force.baud_code = kFactoryBaudCode;
    in_force.protocol = Protocol::Ascii;
    in_force.checksum = false;
  } else {
    in_force.address = settings.address;
    in_force.baud_code = settings.baud_code;
    in_force.protocol = settings.protocol;
    in_force.checksum = (settings.format & kFormatChecksum) != 0;
  }
  state.inputs.configure(in_force.protocol == Protocol::Ascii ? Inputs::CounterRange::FiveDigits
                                                              : Inputs::CounterRange::SixteenBits,
                         (settings.format & kFormatRisingEdge) != 0);
  init_gives_up_.disarm();
  const LineTiming timing = timing_at_(baud());
  turn_around_ = ascii() ? timing.dcon_turn_around : timing.rtu_silence;
  receiver_.listen({in_force.protocol, in_force.checksum, timing});
  receiver_.answer_to(in_force.address);
  phase_ = Phase::Idle;
}

// --- what the interrupts have gathered ---

void Module::collect_edges() {
  // Before it listens, which edges the counters count is not settled.
  if (kBuiltInputs != 0 && listening() && edges_collected_ != edges_.edges()) {
    edges_collected_ = edges_.edges();
    exchange_.state_.inputs.collect(edges_, state().model().inputs);
    judgement_stands_ = false;
  }
}

void Module::heed_host_ok() {
  const std::uint32_t host_oks = receiver_.host_oks();
  if (host_oks == host_oks_heeded_) {
    return;
  }
  host_oks_heeded_ = host_oks;
  // It counts from when it was over, and comes too late where the timeout was over before.
  const Time received = receiver_.host_ok_time();
  expire_host_watchdog(received);
  host_watchdog_.restart(received);
}

void Module::expire_host_watchdog(Time now) {
  State& state = exchange_.state_;
  if (!state.settings.watchdog_enabled || !host_watchdog_.expired(state.settings, now)) {
    return;
  }
  // At once and whatever the memory does; that it is stored follows (store_leftovers).
  expired_since_judged_ = leftovers_ = true;
  judgement_stands_ = false;
  state.settings.timeout_status = true;
  state.settings.watchdog_enabled = false;
  state.outputs = state.settings.safe_value;
}

// --- requests ---

/// A request is judged in the silence behind it, and acted upon when that is over, unless what it was judged
/// by has changed meanwhile.
void Module::attend(Time now) {
  collect_edges();
  const FrameQueue& queue = receiver_.queue();
  if (!queue.has_frame()) {
    const std::uint32_t number = queue.announced();
    if (number != judged_) {
      judged_ = number;
      judgement_stands_ = false;
      const Bytes coming = queue.coming().bytes();
      if (Frame::is_size(coming.size)) {
        judge(coming, false);
        // Where the silence ended meanwhile, what was read may be the next one's, and the tallies may have
        // this one.
        judgement_stands_ = !queue.has_frame();
      }
    }
    return;
  }
  if (queue.waiting_number() != judged_ || !judgement_stands_) {
    judged_ = queue.waiting_number();
    judge(queue.completed().bytes(), true);
  }
  if (silence_left(now) == Duration()) {
    receiver_.queue().drop_in_main_loop();
    act(now);
  }
}

/// Until the frame that waits may be acted upon. Of a Modbus frame only its silence tells that it is
/// complete.
Duration Module::silence_left(Time now) const {
  if (!ascii()) {
    return {};
  }
  // Not "how long since": it may have come in after the main loop took its `now`.
  Deadline over;
  over.set(receiver_.queue().completed().received + turn_around_);
  return over.remaining(now);
}

/// Changes nothing but the exchange.
void Module::judge(Bytes frame, bool complete) {
  judgement_stands_ = true;
  expired_since_judged_ = false;
  exchange_.frame = frame;
  exchange_.tallied = complete;
  exchange_.outcome.clear();
  exchange_.reply.clear();
  if (ascii()) {
    dcon::answer(exchange_);
  } else {
    modbus::answer(exchange_);
  }
  Outcome& outcome = exchange_.outcome;
  if (outcome.refusal != Refusal::None) {
    outcome.clear();  // a refused request changes nothing
  } else if (outcome.changes_settings()) {
    prepare_store();
  }
}

void Module::prepare_store() {
  changed_ = exchange_.outcome.change().applied_to(state().settings);
  stores_ = changed_ != store_.stored();
}

void Module::act(Time now) {
  const Outcome& outcome = exchange_.outcome;
  if (outcome.refusal != Refusal::None) {
    count_exception();
  }
  if (outcome.empty()) {
    answered();
  } else if (outcome.changes_settings()) {
    phase_ = Phase::MustStore;
    go_on_storing(now);
  } else {
    carry_out(now);
  }
}

void Module::answered() {
  if (exchange_.reply.empty()) {
    ++exchange_.state_.diagnostics.no_responses;
    phase_ = Phase::Idle;
  } else {
    phase_ = Phase::ReplyReady;
  }
}

void Module::carry_out(Time now) {
  State& state = exchange_.state_;
  const Outcome& outcome = exchange_.outcome;
  if (outcome.changes_settings()) {
    state.settings = outcome.change().applied_to(state.settings);
    if (expired_since_judged_) {
      // What was cleared is the timeout before that (D17); the safe value may be new (D6).
      state.settings.timeout_status = true;
      state.outputs = state.settings.safe_value;
    }
  }
  if (!state.outputs_blocked()) {
    const Drive drive = outcome.outputs_to_drive();
    state.outputs = static_cast<std::uint16_t>((state.outputs & ~drive.mask) | (drive.value & drive.mask));
  }
  if (outcome.has_effects()) {
    have_effects(now);
  }
  exchange_.outcome.clear();
  answered();
}

void Module::have_effects(Time now) {
  State& state = exchange_.state_;
  const Outcome& outcome = exchange_.outcome;
  if (outcome.asks_for(Effect::RestartHostWatchdog)) {
    host_watchdog_.restart(now);
  }
  if (outcome.asks_for(Effect::TakeAddress)) {
    state.in_force.address = state.settings.address;
    receiver_.answer_to(state.settings.address);
  }
  if (outcome.asks_for(Effect::TakeSample)) {
    state.sample = {true, false, state.outputs, state.inputs.levels()};
  }
  if (outcome.asks_for(Effect::MarkSampleRead)) {
    state.sample.read = true;
  }
  if (outcome.asks_for(Effect::ClearResetStatus)) {
    state.reset_status = false;
  }
  if (outcome.asks_for(Effect::ClearLatches)) {
    state.inputs.clear_latches();
  }
  if (outcome.asks_for(Effect::ClearCounters)) {
    state.inputs.clear_counters(outcome.counters_to_clear);
  }
  if (outcome.asks_for(Effect::ClearDiagnostics)) {
    receiver_.tallies().clear();
    state.diagnostics = Diagnostics();
  }
}

void Module::refuse_store() {
  exchange_.outcome.clear();
  exchange_.outcome.refusal = Refusal::StoreFailed;
  if (ascii()) {
    dcon::refuse_store(exchange_);
  } else {
    modbus::refuse_store(exchange_);
  }
  count_exception();
  answered();
}

void Module::count_exception() {
  if (!exchange_.reply.empty()) {
    ++exchange_.state_.diagnostics.exceptions;
  }
}

Bytes Module::take_reply(Time now) {
  if (phase_ != Phase::ReplyReady || (line_quiet_.armed() && !line_quiet_.reached(now))) {
    return {};
  }
  phase_ = Phase::Replying;
  return exchange_.reply.bytes();
}

void Module::reply_sent(Time now) {
  phase_ = Phase::Idle;
  line_quiet_.set(now + turn_around_);
}

// --- storing ---

void Module::go_on_storing(Time now) {
  if (store_.busy()) {
    return;
  }
  if (storing_leftovers_) {
    storing_leftovers_ = false;
    if (!store_.saved()) {
      leftovers_retry_.set(now + kStoreRetry);
    }
  }
  if (phase_ == Phase::MustStore) {
    if (!judgement_stands_) {
      prepare_store();
    }
    if (!stores_) {
      carry_out(now);  // a command that changes nothing writes nothing
    } else {
      store_.begin_saving(changed_);
      phase_ = Phase::Storing;
    }
  } else if (phase_ == Phase::Storing) {
    leftovers_ = true;
    if (store_.saved()) {
      carry_out(now);
    } else {
      refuse_store();
    }
  }
}

/// A timeout that is not stored yet; a copy in the memory that may hold what was refused.
void Module::store_leftovers(Time now) {
  const bool unstored = state().settings != store_.stored();
  if (!unstored && !store_.doubtful()) {
    leftovers_ = false;
    leftovers_retry_.disarm();
    return;
  }
  if (store_.busy() || (leftovers_retry_.armed() && !leftovers_retry_.reached(now))) {
    return;
  }
  leftovers_retry_.disarm();
  storing_leftovers_ = true;
  if (unstored) {
    store_.begin_saving(state().settings);
  } else {
    store_.begin_settling();
  }
}

std::optional<Duration> Module::idle_for(Time now) const {
  const bool memory_has_news =
      !store_.busy() && (!settings_known_ || storing_leftovers_ || phase_ == Phase::Storing);
  const bool line_has_news = (phase_ == Phase::Idle && receiver_.queue().announced() != judged_) ||
                             receiver_.host_oks() != host_oks_heeded_;
  if (memory_has_news || line_has_news || led_.pattern() != led_pattern_due()) {
    return Duration();
  }
  std::optional<Duration> idle;
  const auto wait_at_most = [&idle](Duration duration) {
    if (!idle || duration < *idle) {
      idle = duration;
    }
  };
  const auto consider = [&wait_at_most, now](const Deadline& deadline) {
    if (deadline.armed()) {
      wait_at_most(deadline.remaining(now));
    }
  };
  consider(init_switch_.settles());
  consider(led_.next_change());
  if (!settings_known_) {
    return idle;
  }
  consider(init_gives_up_);
  consider(host_watchdog_.expiry(state().settings));
  if (!store_.busy()) {
    consider(leftovers_retry_);
  }
  if (phase_ == Phase::Idle && receiver_.queue().has_frame()) {
    wait_at_most(silence_left(now));
  }
  if (phase_ == Phase::ReplyReady) {
    wait_at_most(line_quiet_.armed() ? line_quiet_.remaining(now) : Duration());
  }
  return idle;
}

}  // namespace ex9000
