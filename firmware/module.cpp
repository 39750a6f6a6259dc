#include "firmware/module.hpp"

#include "firmware/dcon/dcon.hpp"
#include "firmware/modbus/modbus.hpp"

namespace ex9000 {

namespace {

constexpr Duration kStoreRetry = milliseconds(1000);  // D15
constexpr Duration kInitGivesUp = milliseconds(50);   // D13

constexpr std::uint8_t kInitModeAddress = 0x00;

void add(std::uint16_t& counter, EventTally& tally) {
  counter = static_cast<std::uint16_t>(counter + tally.collect());
}

}  // namespace

void Module::begin(std::uint16_t input_levels, Time now, TimingAt timing_at) {
  timing_at_ = timing_at;
  edges_.begin(input_levels & state_.model().input_mask());
  store_.begin_loading();
  init_gives_up_.set(now + kInitGivesUp);
  led_.show(StatusLed::Pattern::Steady, now);
}

void Module::look_around(bool init_switch, Time now) {
  init_switch_.sample(init_switch, now);
  state_.init_asserted = init_switch_.level();
  led_.show(led_pattern_due(), now);
}

StatusLed::Pattern Module::led_pattern_due() const {
  if (state_.settings.timeout_status) {
    return StatusLed::Pattern::HostTimeout;
  }
  return settings_known_ && settings_unreadable() ? StatusLed::Pattern::SettingsUnreadable
                                                  : StatusLed::Pattern::Steady;
}

void Module::step(Time now) {
  if (!settings_known_ && !store_.loading()) {
    use_settings(now);
  }
  if (line_quiet_.reached(now)) {
    line_quiet_.disarm();
  }
  if (!settings_known_) {
    return;
  }
  if (phase_ == Phase::Booting && init_is_known(now)) {
    start_listening();
  }
  // What a frame is judged by is collected after it was there, so that it includes the frame itself.
  const Frame* frame = receiver_.queue().waiting();
  collect_tallies();
  heed_host_ok();
  expire_host_watchdog(now);  // before anything that drives outputs
  go_on_storing(now);
  if (phase_ == Phase::Idle && frame != nullptr) {
    judge(*frame, now);
    receiver_.queue().drop_in_main_loop();
  }
  store_leftovers(now);
}

// --- reset ---

/// A switch that never stands still is no reason not to come up.
bool Module::init_is_known(Time now) const { return init_switch_.known() || init_gives_up_.reached(now); }

void Module::use_settings(Time now) {
  settings_known_ = true;
  const Settings& settings = state_.settings = store_.stored();
  state_.outputs = settings.timeout_status ? settings.safe_value : settings.power_on_value;
  host_watchdog_.restart(now);
}

void Module::start_listening() {
  const Settings& settings = state_.settings;
  InForce& in_force = state_.in_force;
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
  state_.inputs.configure(in_force.protocol == Protocol::Ascii ? Inputs::CounterRange::FiveDigits
                                                               : Inputs::CounterRange::SixteenBits,
                          (settings.format & kFormatRisingEdge) != 0);
  init_gives_up_.disarm();
  receiver_.answer_to(in_force.address);
  receiver_.listen({in_force.protocol, in_force.checksum, timing_at_(baud())});
  phase_ = Phase::Idle;
}

// --- what the interrupts have gathered ---

void Module::collect_tallies() {
  if (phase_ == Phase::Booting) {
    return;  // what the counters count is not settled yet
  }
  state_.inputs.collect(edges_, state_.model().inputs);
  LineTallies& tallies = receiver_.tallies();
  Diagnostics& diagnostics = state_.diagnostics;
  add(diagnostics.bus_messages, tallies.bus_messages);
  add(diagnostics.bus_errors, tallies.bus_errors);
  add(diagnostics.server_messages, tallies.server_messages);
  add(diagnostics.no_responses, tallies.no_responses);
  add(diagnostics.overruns, tallies.overruns);
}

void Module::heed_host_ok() {
  const std::uint8_t host_oks = receiver_.host_oks();
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
  if (!host_watchdog_.expired(state_.settings, now)) {
    return;
  }
  // At once and whatever the memory does; that it is stored follows (store_leftovers).
  expired_since_judged_ = true;
  state_.settings.timeout_status = true;
  state_.settings.watchdog_enabled = false;
  state_.outputs = state_.settings.safe_value;
}

// --- requests ---

void Module::judge(const Frame& frame, Time now) {
  outcome_ = Outcome();
  expired_since_judged_ = false;
  reply_.clear();
  const bool ascii = state_.in_force.protocol == Protocol::Ascii;
  if (ascii) {
    dcon::answer(state_, frame.bytes(), outcome_, reply_);
  } else {
    modbus::answer(state_, frame.bytes(), outcome_, reply_);
  }
  reply_due_.set(frame.received + turn_around());
  if (outcome_.refusal != Refusal::None) {
    outcome_ = Outcome::refused(outcome_.refusal);  // a refused request changes nothing
    count_exception();
  }
  if (reply_.empty()) {
    ++state_.diagnostics.no_responses;
  }
  if (outcome_.change.empty()) {
    carry_out(now);
  } else {
    phase_ = Phase::MustStore;
    go_on_storing(now);
  }
}

void Module::carry_out(Time now) {
  Settings& settings = state_.settings;
  settings = outcome_.change.applied_to(settings);
  settings.timeout_status |= expired_since_judged_;  // what was cleared is the timeout before that (D17)
  if (outcome_.take_address) {
    state_.in_force.address = settings.address;
    receiver_.answer_to(settings.address);
  }
  if (outcome_.restart_host_watchdog) {
    host_watchdog_.restart(now);
  }
  if (settings.timeout_status) {
    state_.outputs = settings.safe_value;  // the host watchdog may have expired while this was stored (D6)
  } else {
    const Drive drive = outcome_.drive;
    state_.outputs = static_cast<std::uint16_t>((state_.outputs & ~drive.mask) | (drive.value & drive.mask));
  }
  if (outcome_.take_sample) {
    state_.sample = {true, false, state_.outputs, state_.inputs.levels()};
  }
  state_.sample.read |= outcome_.sample_read;
  state_.reset_status &= !outcome_.reset_status_read;
  if (outcome_.clear_latches) {
    state_.inputs.clear_latches();
  }
  state_.inputs.clear_counters(outcome_.clear_counters);
  if (outcome_.clear_diagnostics) {
    state_.diagnostics = Diagnostics();
  }
  finish_request();
}

void Module::refuse_store() {
  outcome_ = Outcome::refused(Refusal::StoreFailed);
  if (state_.in_force.protocol == Protocol::Ascii) {
    dcon::refuse_store(state_, reply_);
  } else {
    modbus::refuse_store(reply_);
  }
  count_exception();
  finish_request();
}

void Module::count_exception() {
  if (!reply_.empty()) {
    ++state_.diagnostics.exceptions;
  }
}

void Module::finish_request() { phase_ = reply_.empty() ? Phase::Idle : Phase::ReplyReady; }

/// Silence before a reply: behind the request, and behind the reply before it.
Duration Module::turn_around() const {
  const LineTiming& timing = receiver_.timing();
  return state_.in_force.protocol == Protocol::Ascii ? timing.dcon_turn_around : timing.rtu_silence;
}

Bytes Module::take_reply(Time now) {
  if (phase_ != Phase::ReplyReady || !reply_due_.reached(now) || line_quiet_.armed()) {
    return {};
  }
  phase_ = Phase::Replying;
  reply_due_.disarm();
  return reply_.bytes();
}

void Module::reply_sent(Time now) {
  phase_ = Phase::Idle;
  line_quiet_.set(now + turn_around());
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
    const Settings changed = outcome_.change.applied_to(state_.settings);
    if (changed == store_.stored()) {
      carry_out(now);  // a command that changes nothing writes nothing
    } else {
      store_.begin_saving(changed);
      phase_ = Phase::Storing;
    }
  } else if (phase_ == Phase::Storing) {
    if (store_.saved()) {
      carry_out(now);
    } else {
      refuse_store();
    }
  }
}

/// A timeout that is not stored yet; a copy in the memory that may hold what was refused.
void Module::store_leftovers(Time now) {
  const bool unstored = state_.settings != store_.stored();
  if (!unstored && !store_.doubtful()) {
    leftovers_retry_.disarm();
    return;
  }
  if (!memory_is_free() || (leftovers_retry_.armed() && !leftovers_retry_.reached(now))) {
    return;
  }
  leftovers_retry_.disarm();
  storing_leftovers_ = true;
  if (unstored) {
    store_.begin_saving(state_.settings);
  } else {
    store_.begin_settling();
  }
}

bool Module::memory_is_free() const {
  return !store_.busy() && phase_ != Phase::MustStore && phase_ != Phase::Storing;
}

std::optional<Duration> Module::idle_for(Time now) const {
  const bool memory_has_news = !store_.busy() && (!settings_known_ || storing_leftovers_ ||
                                                  phase_ == Phase::MustStore || phase_ == Phase::Storing);
  const bool request_waits = (phase_ == Phase::Idle && receiver_.queue().waiting() != nullptr) ||
                             receiver_.host_oks() != host_oks_heeded_;
  if (memory_has_news || request_waits || led_.pattern() != led_pattern_due()) {
    return Duration();
  }
  std::optional<Duration> idle;
  const auto consider = [&idle, now](const Deadline& deadline) {
    if (deadline.armed() && (!idle || deadline.remaining(now) < *idle)) {
      idle = deadline.remaining(now);
    }
  };
  consider(init_switch_.settles());
  consider(led_.next_change());
  if (!settings_known_) {
    return idle;
  }
  consider(init_gives_up_);
  consider(host_watchdog_.expiry(state_.settings));
  if (memory_is_free()) {
    consider(leftovers_retry_);
  }
  if (phase_ == Phase::ReplyReady) {
    consider(line_quiet_.armed() ? line_quiet_ : reply_due_);
  }
  return idle;
}

}  // namespace ex9000
