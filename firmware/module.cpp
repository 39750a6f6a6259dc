#include "firmware/module.hpp"

#include "firmware/dcon/dcon.hpp"
#include "firmware/modbus/modbus.hpp"

namespace ex9000 {

namespace {

constexpr Duration kTimeoutStoreRetry = milliseconds(1000);  // D15

constexpr std::uint8_t kInitModeAddress = 0x00;

void add(std::uint16_t& counter, EventTally& tally) {
  counter = static_cast<std::uint16_t>(counter + tally.collect());
}

}  // namespace

void Module::begin(std::uint16_t input_levels, Time now, InterCharacterGap gap) {
  gap_ = gap;
  edges_.begin(input_levels & state_.model.input_mask());
  store_.begin_loading();
  led_.show(StatusLed::Pattern::Steady, now);
}

void Module::step(bool init_switch, Time now) {
  init_switch_.sample(init_switch, now);
  state_.init_asserted = init_switch_.level();
  if (phase_ == Phase::Booting) {
    boot(now);
  }
  if (phase_ != Phase::Booting) {
    collect_tallies();
    heed_host_ok();
    expire_host_watchdog(now);  // before anything that drives outputs
    go_on_storing(now);
    const Frame* frame = receiver_.queue().waiting();
    if (phase_ == Phase::Idle && frame != nullptr) {
      judge(*frame, now);
      receiver_.queue().drop_in_main_loop();
    }
    store_timeout(now);
  }
  led_.show(state_.settings.timeout_status ? StatusLed::Pattern::HostTimeout
            : settings_known_ && settings_unreadable() ? StatusLed::Pattern::SettingsUnreadable
                                                       : StatusLed::Pattern::Steady,
            now);
}

// --- reset ---

void Module::boot(Time now) {
  if (store_.loading()) {
    return;
  }
  if (!settings_known_) {
    use_settings(now);
  }
  if (init_switch_.known()) {
    start_listening();
  }
}

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
  receiver_.answer_to(in_force.address);
  receiver_.listen({in_force.protocol, in_force.checksum, LineTiming::at(baud()), gap_});
  phase_ = Phase::Idle;
}

// --- what the interrupts have gathered ---

void Module::collect_tallies() {
  state_.inputs.collect(edges_, state_.model.inputs);
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
  // It counts from when it was received, and comes too late where the timeout was over by then.
  const Time received = receiver_.host_ok_time();
  expire_host_watchdog(received);
  host_watchdog_.restart(received);
}

void Module::expire_host_watchdog(Time now) {
  if (!host_watchdog_.expired(state_.settings, now)) {
    return;
  }
  // At once and whatever the memory does; that it is stored follows (store_timeout).
  state_.settings.timeout_status = true;
  state_.settings.watchdog_enabled = false;
  state_.outputs = state_.settings.safe_value;
}

// --- requests ---

void Module::judge(const Frame& frame, Time now) {
  outcome_ = Outcome();
  reply_.clear();
  const bool ascii = state_.in_force.protocol == Protocol::Ascii;
  if (ascii) {
    dcon::answer(state_, frame.bytes(), outcome_, reply_);
  } else {
    modbus::answer(state_, frame.bytes(), outcome_, reply_);
  }
  const LineTiming timing = LineTiming::at(baud());
  reply_due_.set(frame.received + (ascii ? timing.character : timing.rtu_silence));
  if (outcome_.refusal != Refusal::None) {
    outcome_ = Outcome::refused(outcome_.refusal);  // a refused request changes nothing
    count_exception();
  }
  if (reply_.empty()) {
    ++state_.diagnostics.no_responses;
  }
  const Settings changed = outcome_.change.applied_to(state_.settings);
  if (changed == state_.settings || (changed == store_.stored() && !store_.busy())) {
    carry_out(now);  // nothing changes, so nothing is written
  } else {
    phase_ = Phase::MustStore;
    go_on_storing(now);
  }
}

void Module::carry_out(Time now) {
  Settings& settings = state_.settings;
  settings = outcome_.change.applied_to(settings);
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

Bytes Module::take_reply(Time now) {
  if (phase_ != Phase::ReplyReady || !reply_due_.reached(now)) {
    return {};
  }
  phase_ = Phase::Replying;
  reply_due_.disarm();
  receiver_.speaking();
  return reply_.bytes();
}

void Module::reply_sent() { phase_ = Phase::Idle; }

// --- storing ---

void Module::go_on_storing(Time now) {
  if (store_.busy()) {
    return;
  }
  if (storing_timeout_) {
    storing_timeout_ = false;
    if (!store_.saved()) {
      timeout_store_retry_.set(now + kTimeoutStoreRetry);
    }
  }
  if (phase_ == Phase::MustStore) {
    store_.begin_saving(outcome_.change.applied_to(state_.settings));
    phase_ = Phase::Storing;
  } else if (phase_ == Phase::Storing) {
    if (store_.saved()) {
      carry_out(now);
    } else {
      refuse_store();
    }
  }
}

void Module::store_timeout(Time now) {
  if (state_.settings == store_.stored()) {
    timeout_store_retry_.disarm();
    return;
  }
  if (!memory_is_free() || (timeout_store_retry_.armed() && !timeout_store_retry_.reached(now))) {
    return;
  }
  timeout_store_retry_.disarm();
  storing_timeout_ = true;
  store_.begin_saving(state_.settings);
}

bool Module::memory_is_free() const {
  return !store_.busy() && phase_ != Phase::MustStore && phase_ != Phase::Storing;
}

std::optional<Duration> Module::idle_for(Time now) const {
  std::optional<Duration> idle;
  const auto consider = [&idle, now](const Deadline& deadline) {
    if (deadline.armed() && (!idle || deadline.remaining(now) < *idle)) {
      idle = deadline.remaining(now);
    }
  };
  consider(init_switch_.settles());
  consider(led_.next_change());
  if (phase_ == Phase::Booting) {
    return idle;
  }
  if ((phase_ == Phase::Idle && receiver_.queue().waiting() != nullptr) ||
      receiver_.host_oks() != host_oks_heeded_) {
    return Duration();
  }
  consider(host_watchdog_.expiry(state_.settings));
  if (memory_is_free()) {
    consider(timeout_store_retry_);
  }
  if (phase_ == Phase::ReplyReady) {
    consider(reply_due_);
  }
  return idle;
}

}  // namespace ex9000
