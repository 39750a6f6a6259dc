// Power, watchdog, timed outputs and whole requests of the reference: wire.md 2, 3, 6 and 12.
#include "tests/oracles/reference/module.hpp"

#include <algorithm>

namespace ex9000::reference {

namespace {

constexpr std::chrono::milliseconds kTimeoutUnit{100};  // wire.md 6: VV x 0.1 s
/// Covers one tick, and the time from the end of the silence after a request until the main loop of the
/// firmware executes the request.
constexpr std::chrono::milliseconds kTick{3};
/// The longest silence that ends a Modbus frame: 32.08 ms at 1200 baud (wire.md 7), rounded up. The time
/// between an ASCII frame and its judgement is shorter.
constexpr std::chrono::milliseconds kLongestSilence{33};

/// Returns the level after the data bits: the parity bit, or the first stop bit if there is no parity.
bool ninth_bit(std::uint8_t byte, LineFormat format) {
  unsigned ones = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    ones += byte >> bit & 1U;
  }
  switch (format) {
    case LineFormat::k8E1:
      return ones % 2 != 0;
    case LineFormat::k8O1:
      return ones % 2 == 0;
    default:
      return true;
  }
}

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

Module::Module(const ModelRow& row, Extensions extensions) : row_(row), extensions_(extensions) {
  // wire.md 2, factory settings.
  stored_.modbus = row.both_protocols;
  stored_.name = row.name;
}

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

void Module::power(bool on, Time now) {
  powered_ = on;
  outputs_ = 0;
  expiry_.reset();
  settling_ = {};
  timers_ = {};
  if (on) {
    reset_reason_ = 1;  // power-on
    come_up(now);
  }
}

void Module::reset(Time now) {
  if (powered_) {
    reset_reason_ = 4;  // reset pin
    come_up(now);
  }
}

void Module::come_up(Time now) {
  // wire.md 2: the module selects its mode only at reset. If INIT* is asserted then, the module uses ASCII,
  // address 00, 9600 baud, 8N1 and no checksum.
  init_mode_ = init_asserted_;
  runs_modbus_ = !init_mode_ && stored_.modbus;
  address_ = init_mode_ ? 0x00 : stored_.address;
  baud_code_ = init_mode_ ? 0x06 : stored_.baud_code;
  checksum_ = !init_mode_ && (stored_.format & 0x40) != 0;
  counts_rising_ = (stored_.format & 0x80) != 0;
  rule(init_mode_ ? "reset into INIT mode" : runs_modbus_ ? "reset into Modbus" : "reset into ASCII");
  rule(std::string("reset into ") + name_of(format()));
  outputs_ = stored_.timed_out ? stored_.safe : stored_.power_on;
  rule(stored_.timed_out ? "reset to the safe value" : "reset to the power-on value");
  end_timed_outputs("reset");
  reset_status_ = true;
  counters_ = {};
  wide_counters_ = {};
  clear_latches();
  // extensions.md: at reset, the levels before the filter are the baseline and do not count as edges.
  levels_ = raw_levels();
  settling_ = {};
  sample_.reset();
  framing_ = Framing::Nothing;
  frame_.clear();
  spoiled_ = false;
  counts_ = {};
  came_up_ = now;
  timeouts_ = 0;
  stores_ = 0;
  read_blank_memory_ = blank_memory_;
  stored_by_ = Time(0);
  timeout_stored_ = Time(0);
  // wire.md 6: if the host watchdog is enabled, every reset starts it with its full timeout, in every mode.
  expiry_.reset();
  if (stored_.enabled) {
    rule("reset starts the host watchdog");
    expiry_ = Moment{now + stored_.timeout * kTimeoutUnit, now + kComingUp + stored_.timeout * kTimeoutUnit};
  }
}

/// Returns the value of registers 0x0302 and 0x0303. Sets `left_open_` if the value is not known.
unsigned Module::seconds_since_reset() {
  const auto seconds = [](Time time) { return std::chrono::duration_cast<std::chrono::seconds>(time); };
  const auto least = seconds(now_ - came_up_ - kComingUp);
  const auto most = seconds(now_ - came_up_ + kLongestStore);
  if (least != most) {
    left_open_ = "the exact time of the reset is not known, and the request may wait for a store";
  }
  return static_cast<unsigned>(least.count());
}

// --- wire.md 6 ---

/// Restarts the host watchdog by a command, if the host watchdog is enabled. If the command changes settings,
/// the restart happens when they are stored.
void Module::restart_host_watchdog() {
  if (stored_.enabled) {
    restarted_ = true;
    expiry_ =
        Moment{now_ + stored_.timeout * kTimeoutUnit, now_ + kLongestStore + stored_.timeout * kTimeoutUnit};
  }
}

void Module::restart_host_watchdog_by_host_ok() {
  if (stored_.enabled) {
    // The module may still be storing a command that restarts the host watchdog. The restart by that command
    // then happens after the restart by the host OK.
    const Time latest = now_ + kLongestSilence + stored_.timeout * kTimeoutUnit;
    expiry_ =
        Moment{now_ + stored_.timeout * kTimeoutUnit, expiry_ ? std::max(expiry_->latest, latest) : latest};
  }
}

/// Restarts the host watchdog if it is enabled and register 0x0251 is 1. Call this for each correctly
/// received request with this module's own address, before the module executes the request.
void Module::restart_host_watchdog_by_request() {
  if (stored_.restarted_by_requests == 1) {
    rule(!expiry_       ? "request does not start a host watchdog that does not run"
         : runs_modbus_ ? "Modbus request restarts the host watchdog"
                        : "ASCII request restarts the host watchdog");
    restart_host_watchdog_by_host_ok();
  }
}

// --- extensions.md: timed outputs ---

/// Sets outputs by a command. The command ends the timers of all channels that it covers.
void Module::drive(unsigned channels, unsigned values) {
  outputs_ = (outputs_ & ~channels) | (values & channels);
  if ((timed_outputs() & channels) != 0) {
    rule("command ends a timed output");
  }
  for (unsigned channel = 0; channel < row_.outputs; ++channel) {
    if ((channels >> channel & 1U) != 0) {
      timers_[channel].reset();
    }
  }
}

/// Switches an output on for `time` x 0.1 s. If `time` is 0, switches the output off.
void Module::set_timed_output(unsigned channel, unsigned time) {
  rule(time == 0 ? "timed output of 0" : "timed output starts");
  const unsigned bit = 1U << channel;
  drive(bit, time != 0 ? bit : 0);
  if (time != 0) {
    timers_[channel] = Moment{now_ + time * kTimeoutUnit, executed_by() + time * kTimeoutUnit};
    timers_started_ |= bit;
  }
}

/// Returns the remaining time of a timed output in units of 0.1 s, rounded up; 0 if no time is running. Sets
/// `left_open_` if the remaining time is not known.
unsigned Module::time_left(unsigned channel) {
  const std::optional<Moment>& timer = timers_[channel];
  rule(timer ? "0x0280 reads the remaining time" : "0x0280 reads 0");
  if (!timer) {
    return 0;
  }
  const auto rounded_up = [](Time time) { return (time + kTimeoutUnit - Time(1)) / kTimeoutUnit; };
  const auto most = rounded_up(timer->latest + kTick - now_);
  if (most != rounded_up(timer->earliest - kTick - executed_by())) {
    left_open_ = "the remaining time of a timed output is not known exactly";
  }
  return static_cast<unsigned>(most);
}

void Module::end_timed_outputs(const std::string& by) {
  if (timed_outputs() != 0) {
    rule(by + " ends a timed output");
  }
  timers_ = {};
}

/// Returns the channels with a running timer.
unsigned Module::timed_outputs() const {
  unsigned channels = 0;
  for (unsigned channel = 0; channel < row_.outputs; ++channel) {
    channels |= timers_[channel] ? 1U << channel : 0U;
  }
  return channels;
}

/// Returns the latest time at which the module executes a request that it has received at `now_`, if the
/// request itself stores nothing. The request may wait while something else is being stored.
Time Module::executed_by() const { return std::max({now_ + kLongestSilence, stored_by_, timeout_stored_}); }

void Module::replied(Time now) {
  if (restarted_ && expiry_) {
    expiry_->latest = now + stored_.timeout * kTimeoutUnit;
  }
  for (unsigned channel = 0; channel < row_.outputs; ++channel) {
    if ((timers_started_ >> channel & 1U) != 0 && timers_[channel]) {
      timers_[channel]->latest = now + (timers_[channel]->earliest - now_);
    }
  }
}

std::vector<Module::Moment> Module::moments() const {
  std::vector<Moment> moments;
  if (expiry_) {
    moments.push_back(*expiry_);
  }
  for (unsigned channel = 0; channel < 16; ++channel) {
    for (const std::optional<Moment>& moment : {settling_[channel], timers_[channel]}) {
      if (moment) {
        moments.push_back(*moment);
      }
    }
  }
  return moments;
}

void Module::pass(Time now) {
  if (powered_ && expiry_ && now > expiry_->latest) {
    rule(stored_.timed_out ? "host watchdog expires again" : "host watchdog expires");
    outputs_ = stored_.safe;
    stored_.timed_out = true;
    stored_.enabled = false;
    timeouts_ += 1;
    stores_ += 1;
    blank_memory_ = false;
    timeout_stored_ = expiry_->latest + kLongestStore;
    expiry_.reset();
    end_timed_outputs("host watchdog");
  }
  for (unsigned channel = 0; channel < row_.outputs; ++channel) {
    if (timers_[channel] && now > timers_[channel]->latest) {
      rule("timed output ends");
      timers_[channel].reset();
      outputs_ &= ~(1U << channel);
    }
  }
  for (unsigned channel = 0; channel < row_.inputs; ++channel) {
    if (settling_[channel] && now > settling_[channel]->latest) {
      rule("the input filter accepts the level");
      settling_[channel].reset();
      take_level(channel);
    }
  }
}

// --- whole requests ---

Answer Module::on_bytes(const Bytes& bytes, LineFormat sent_in, Time now) {
  Answer answer;
  if (!powered_) {
    return answer;
  }
  now_ = now;
  restarted_ = false;
  timers_started_ = 0;
  left_open_ = nullptr;
  const Stored before = stored_;
  const bool delayed = reply_delay() != Time(0);
  // A byte is bad if the bit after its data bits differs from the bit that the module expects there: the
  // correct parity bit, or the stop bit if the module uses no parity.
  std::vector<bool> bad;
  for (const std::uint8_t byte : bytes) {
    bad.push_back(ninth_bit(byte, sent_in) != ninth_bit(byte, format()));
    counts_.bad_bytes += bad.back() ? 1U : 0U;
  }
  if (runs_modbus_) {
    answer.reply = modbus_frame(bytes, bad);
  } else {
    // wire.md 3: outside a frame, a delimiter begins a frame, and `!`, `>` or `?` begins another module's
    // reply. The module skips this reply up to its CR.
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const char character = static_cast<char>(bytes[i]);
      // `now_` is the time at which this byte ends. If one of several frames restarts the host watchdog, the
      // restart happens at the end of that frame.
      now_ = now - Time((bytes.size() - 1 - i) * character_bits(sent_in) * 1'000'000'000ULL / rate());
      if (!answer.reply.empty()) {
        left_open_ =
            "the effect of bytes that arrive while the module replies depends on the time of the reply";
      }
      if (bad[i]) {
        // A bad byte in a frame spoils the frame. The module ignores any other bad byte. A CR with a line
        // error is not a CR.
        rule(framing_ == Framing::Nothing ? "bad byte outside an ASCII frame"
                                          : "bad byte in an ASCII frame or in a skipped reply");
        spoiled_ = true;
      } else if (framing_ == Framing::Nothing) {
        spoiled_ = false;
        if (std::string("#$%@~").find(character) != std::string::npos) {
          framing_ = Framing::Open;
          frame_ = character;
        } else if (std::string("!>?").find(character) != std::string::npos) {
          rule("another module's reply is skipped");
          framing_ = Framing::ToTheCr;
        }
      } else if (character != '\r') {
        frame_ += character;
      } else {
        const bool judged = framing_ == Framing::Open;
        framing_ = Framing::Nothing;
        if (judged) {
          const std::optional<std::string> reply = dcon_frame(frame_, spoiled_);
          if (reply) {
            answer.reply.assign(reply->begin(), reply->end());
          }
        }
        frame_.clear();
      }
    }
  }
  if (!answer.reply.empty() && before.delay != 0) {
    rule(delayed ? "response delay" : "no response delay in INIT mode");
  }
  if (!stored_.enabled) {
    expiry_.reset();
  }
  answer.stores = !(stored_ == before);
  if (answer.stores) {
    stores_ += 1;
    blank_memory_ = false;
    stored_by_ = answer.reply.empty() ? now_ + kLongestStore : stored_by_;
  }
  answer.left_open = left_open_;
  return answer;
}

}  // namespace ex9000::reference
