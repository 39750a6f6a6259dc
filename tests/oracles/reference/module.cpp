// Power, watchdog, timed outputs and whole requests of the reference: wire.md 2, 3, 6 and 12.
#include "tests/oracles/reference/module.hpp"

#include <algorithm>

#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"

namespace ex9000::reference {

namespace {

constexpr std::chrono::milliseconds kTimeoutUnit{100};  // wire.md 6: VV x 0.1 s

}  // namespace

bool baud_code_exists(unsigned code) {
  constexpr unsigned kFirst[] = {0x03, 0x43, 0x83, 0xC3};
  constexpr unsigned kLast[] = {0x0A, 0x4A, 0x8A, 0xCA};
  for (unsigned format = 0; format < 4; ++format) {
    if (code >= kFirst[format] && code <= kLast[format]) {
      return true;
    }
  }
  return false;
}

LineFormat format_of(unsigned baud_code) {
  return baud_code >= 0xC3   ? LineFormat::k8O1
         : baud_code >= 0x83 ? LineFormat::k8E1
         : baud_code >= 0x43 ? LineFormat::k8N2
                             : LineFormat::k8N1;
}

const char* name_of(LineFormat format) {
  switch (format) {
    case LineFormat::k8N1:
      return "8N1";
    case LineFormat::k8N2:
      return "8N2";
    case LineFormat::k8E1:
      return "8E1";
    default:
      return "8O1";
  }
}

Module::Module(const ModelRow& row) : row_(&row) { use_factory_settings(); }

unsigned Module::rate() const {
  // wire.md 4: the baud rates of CC.
  constexpr unsigned kRates[] = {1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  return kRates[baud_code_ % 0x40 - 3];
}

bool Module::waits_for_reset() const {
  return init_mode_ ? !init_asserted_
                    : init_asserted_ || stored_.modbus != runs_modbus_ || stored_.address != address_ ||
                          stored_.baud_code != baud_code_ || ((stored_.format & 0x40) != 0) != checksum_;
}

void Module::power(bool on, Moment when) {
  powered_ = on;
  outputs_ = 0;
  expiry_.reset();
  settling_ = {};
  timers_ = {};
  if (on) {
    reset_reason_ = 1;  // power-on
    crashes_ = 0;
    come_up(when);
  }
}

void Module::reset(Moment when, unsigned reason) {
  if (powered_) {
    reset_reason_ = reason;
    come_up(when);
  }
}

void Module::come_up(Moment when) {
  counts_rising_ = (stored_.format & 0x80) != 0;
  // wire.md 2: after the third reset in a row by the watchdog, too.
  outputs_ = stored_.timed_out || crashes_ >= 3 ? stored_.safe : stored_.power_on;
  reset_status_ = true;
  counters_ = {};
  wide_counters_ = {};
  clear_latches();
  // extensions.md: at reset, the levels before the filter are the baseline and do not count as edges.
  levels_ = raw_levels();
  settling_ = {};
  sample_.reset();
  counts_ = {};
  came_up_ = when;
  timeouts_ = 0;
  stores_ = 0;
  read_blank_memory_ = blank_memory_;
  // wire.md 6: if the host watchdog is enabled, every reset starts it with its full timeout, in every mode.
  expiry_.reset();
  if (stored_.enabled) {
    expiry_ = when + stored_.timeout * kTimeoutUnit;
  }
}

void Module::select_mode(bool init) {
  // wire.md 2: INIT mode uses ASCII, address 00, 9600 baud, 8N1 and no checksum.
  init_mode_ = init;
  runs_modbus_ = !init_mode_ && stored_.modbus;
  address_ = init_mode_ ? 0x00 : stored_.address;
  baud_code_ = init_mode_ ? 0x06 : stored_.baud_code;
  checksum_ = !init_mode_ && (stored_.format & 0x40) != 0;
}

void Module::started(Time by) {
  if (expiry_) {
    expiry_->latest = by + stored_.timeout * kTimeoutUnit;
  }
}

/// Returns the value of registers 0x0302 and 0x0303.
unsigned Module::seconds_since_reset() {
  const auto seconds = [](Time time) {
    return static_cast<unsigned>(std::chrono::duration_cast<std::chrono::seconds>(time).count());
  };
  const unsigned least = seconds(std::max(now_.earliest - came_up_.latest, Time(0)));
  return least + choice(seconds(now_.latest - came_up_.earliest) - least + 1);
}

// --- wire.md 6 ---

/// Restarts the host watchdog, if it is enabled.
void Module::restart_host_watchdog() {
  if (stored_.enabled) {
    expiry_ = now_ + stored_.timeout * kTimeoutUnit;
  }
}

// --- extensions.md: timed outputs ---

/// Sets outputs by a command. The command ends the timers of all channels that it covers.
void Module::drive(unsigned channels, unsigned values) {
  if (stored_.timed_out) {
    return;  // overtaken by a timeout: wire.md D6
  }
  outputs_ = (outputs_ & ~channels) | (values & channels);
  for (unsigned channel = 0; channel < row_->outputs; ++channel) {
    if ((channels >> channel & 1U) != 0) {
      timers_[channel].reset();
    }
  }
}

/// Switches an output on for `time` x 0.1 s. If `time` is 0, switches the output off.
void Module::set_timed_output(unsigned channel, unsigned time) {
  const unsigned bit = 1U << channel;
  drive(bit, time != 0 ? bit : 0);
  if (time != 0 && !stored_.timed_out) {
    timers_[channel] = now_ + time * kTimeoutUnit;
  }
}

/// Returns the remaining time of a timed output in units of 0.1 s, rounded up; 0 if no time is running.
unsigned Module::time_left(unsigned channel) {
  const std::optional<Moment>& timer = timers_[channel];
  if (!timer) {
    return 0;
  }
  const auto rounded_up = [](Time time) {
    return static_cast<unsigned>((std::max(time, Time(0)) + kTimeoutUnit - Time(1)) / kTimeoutUnit);
  };
  const unsigned least = rounded_up(timer->earliest - now_.latest);
  return least + choice(rounded_up(timer->latest + kLate - now_.earliest) - least + 1);
}

/// Returns the channels with a running timer.
unsigned Module::timed_outputs() const {
  unsigned channels = 0;
  for (unsigned channel = 0; channel < row_->outputs; ++channel) {
    channels |= timers_[channel] ? 1U << channel : 0U;
  }
  return channels;
}

void Module::use_factory_settings() {
  stored_ = {};
  stored_.modbus = row_->both_protocols;
  stored_.name = row_->name;
}

void Module::expire() {
  outputs_ = stored_.safe;
  stored_.timed_out = true;
  stored_.enabled = false;
  timeouts_ += 1;
  expiry_.reset();
  timers_ = {};
}

void Module::timeout_stored() {
  stores_ += 1;
  blank_memory_ = false;
}

void Module::end_timed_output(unsigned channel) {
  timers_[channel].reset();
  outputs_ &= ~(1U << channel);
}

void Module::settle_input(unsigned channel) {
  settling_[channel].reset();
  take_level(channel);
}

// --- whole frames ---

Answer Module::on_frame_without_store(const Bytes& bytes, const std::vector<bool>& bad, Moment when,
                                      std::optional<unsigned> overtaken) {
  Module trial = *this;
  Answer answer = trial.on_frame(bytes, bad, when, overtaken);
  counts_ = trial.counts_;
  answer.stores = false;
  if (!answer.reply.empty()) {
    counts_.exceptions += 1;
    if (runs_modbus_) {
      const std::size_t prefix = answer.reply[0] == 0xFD ? 6 : 0;  // a reply by serial number
      answer.reply.resize(prefix + 2);
      answer.reply.back() |= 0x80U;
      answer.reply.push_back(0x04);
      answer.reply = with_crc(answer.reply);
    } else {
      const std::string reply = "?" + aa();
      const std::string line = reply + (checksum_ ? check_of(reply) : "") + "\r";
      answer.reply.assign(line.begin(), line.end());
    }
  }
  return answer;
}

bool Module::on_receipt(const Bytes& bytes, const std::vector<bool>& bad, Moment when) {
  Module trial = *this;
  trial.received_ = Counts();
  trial.on_frame(bytes, bad, when);
  const Counts& seen = trial.received_;
  counts_.bus_messages += seen.bus_messages;
  counts_.server_messages += seen.server_messages;
  counts_.crc_errors += seen.crc_errors;
  if (trial.own_ && stored_.restarted_by_requests == 1) {
    now_ = when;
    restart_host_watchdog();
  }
  return seen.server_messages != 0;
}

void Module::miss_frame() { counts_.server_messages -= 1; }

void Module::lose_frame() {
  counts_.server_messages -= 1;
  counts_.lost += 1;
}

Answer Module::on_frame(const Bytes& bytes, const std::vector<bool>& bad, Moment when,
                        std::optional<unsigned> overtaken) {
  Answer answer;
  now_ = when;
  overtaken_ = overtaken;
  own_ = sets_ = programs_ = is_block_ = false;
  refusal_.clear();
  const Stored before = stored_;
  if (runs_modbus_) {
    answer.reply = modbus_frame(bytes, bad);
  } else {
    const bool spoiled = std::find(bad.begin(), bad.end(), true) != bad.end();
    const auto reply = dcon_frame(std::string(bytes.begin(), bytes.end() - 1), spoiled);
    if (reply) {
      answer.reply.assign(reply->begin(), reply->end());
    }
  }
  if (!stored_.enabled) {
    expiry_.reset();
  }
  if (overtaken && stored_.timed_out) {
    outputs_ = stored_.safe;
  }
  answer.sets = sets_;
  answer.programs = programs_;
  answer.is_block = is_block_;
  answer.refusal = refusal_;
  answer.stores = !(stored_ == before);
  if (answer.stores) {
    stores_ += 1;
    blank_memory_ = false;
  }
  return answer;
}

bool Module::is_like(const Module& other) const {
  const auto state = [](const Module& m) {
    return std::tie(m.stored_, m.blank_memory_, m.powered_, m.init_asserted_, m.init_mode_, m.runs_modbus_,
                    m.address_, m.baud_code_, m.checksum_, m.counts_rising_, m.outputs_, m.reset_status_,
                    m.terminals_, m.last_edges_, m.levels_, m.latch_high_, m.latch_low_, m.counters_,
                    m.wide_counters_, m.sample_, m.counts_, m.reset_reason_, m.timeouts_, m.stores_,
                    m.read_blank_memory_, m.doubts_memory_, m.update_);
  };
  const auto same = [](const std::optional<Moment>& a, const std::optional<Moment>& b) {
    return a.has_value() == b.has_value();
  };
  return same(expiry_, other.expiry_) &&
         std::equal(timers_.begin(), timers_.end(), other.timers_.begin(), same) &&
         std::equal(settling_.begin(), settling_.end(), other.settling_.begin(), same) &&
         state(*this) == state(other);
}

bool Module::widen(const Module& other) {
  bool changed = reference::widen(came_up_, other.came_up_);
  const auto cover = [&](std::optional<Moment>& mine, const std::optional<Moment>& its) {
    changed = (mine && reference::widen(*mine, *its)) || changed;
  };
  cover(expiry_, other.expiry_);
  for (unsigned channel = 0; channel < timers_.size(); ++channel) {
    cover(timers_[channel], other.timers_[channel]);
    cover(settling_[channel], other.settling_[channel]);
  }
  return changed;
}

}  // namespace ex9000::reference
