// Power, inputs and watchdog of the reference: wire.md 2, 5 and 6.
#include "tests/oracles/reference/module.hpp"

#include <tuple>

namespace ex9000::reference {

namespace {

constexpr std::chrono::milliseconds kTimeoutUnit{100};  // wire.md 6: VV x 0.1 s
/// wire.md 3: the reply starts at most 200 ms after a request that stores a setting. A Modbus frame ends up
/// to 32 ms after its last byte.
constexpr std::chrono::milliseconds kLongestStore{232};
/// The silence that ends a frame, wire.md 7, at 1200 baud. A host OK stores nothing.
constexpr std::chrono::milliseconds kLongestSilence{33};

auto members(const Stored& s) {
  return std::tie(s.address, s.baud_code, s.format, s.modbus, s.name, s.power_on, s.safe, s.enabled,
                  s.timeout, s.timed_out);
}

}  // namespace

bool operator==(const Stored& a, const Stored& b) { return members(a) == members(b); }

Module::Module(const ModelRow& row) : row_(row) {
  // wire.md 2, factory settings.
  stored_.modbus = row.both_protocols;
  stored_.name = row.name;
}

unsigned Module::rate() const {
  // The baud rates of CC: README, DCON commands.
  constexpr unsigned kRates[] = {1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  return kRates[baud_code_ - 3];
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
  if (on) {
    come_up(now);
  }
}

void Module::reset(Time now) {
  if (powered_) {
    come_up(now);
  }
}

void Module::come_up(Time now) {
  // wire.md 2: INIT* is sampled only at reset. If asserted, the module uses ASCII, address 00, 9600 baud and
  // no checksum.
  init_mode_ = init_asserted_;
  runs_modbus_ = !init_mode_ && stored_.modbus;
  address_ = init_mode_ ? 0x00 : stored_.address;
  baud_code_ = init_mode_ ? 0x06 : stored_.baud_code;
  checksum_ = !init_mode_ && (stored_.format & 0x40) != 0;
  counts_rising_ = (stored_.format & 0x80) != 0;
  rule(init_mode_ ? "reset into INIT mode" : runs_modbus_ ? "reset into Modbus" : "reset into ASCII");
  outputs_ = stored_.timed_out ? stored_.safe : stored_.power_on;
  rule(stored_.timed_out ? "reset to the safe value" : "reset to the power-on value");
  reset_status_ = true;
  counters_ = {};
  clear_latches();
  sample_.reset();
  framing_ = Framing::Nothing;
  frame_.clear();
  counts_ = {};
  // wire.md 6: every reset starts the host watchdog with its full VV, in every mode.
  expiry_.reset();
  if (stored_.enabled) {
    rule("reset starts the host watchdog");
    expiry_ = Expiry{now + stored_.timeout * kTimeoutUnit, now + kComingUp + stored_.timeout * kTimeoutUnit};
  }
}

// --- wire.md 5 ---

void Module::set_input(unsigned channel, bool level) {
  if (channel >= row_.inputs) {
    return;
  }
  const bool was = (levels_ >> channel & 1U) != 0;
  if (was != level) {
    levels_ ^= 1U << channel;
    edge(channel, level, 1);
  }
}

void Module::pulse_input(unsigned channel, std::uint32_t count) {
  // A pulse goes to the other level and back, so it has as many rising as falling edges.
  edge(channel, true, count);
  edge(channel, false, count);
}

void Module::edge(unsigned channel, bool rising, std::uint32_t count) {
  if (!powered_ || channel >= row_.inputs || count == 0) {
    return;
  }
  (rising ? latch_high_ : latch_low_) |= 1U << channel;
  if (rising == counts_rising_) {
    const std::uint64_t edges = std::uint64_t{counters_[channel]} + count;
    if (edges >= counter_modulus()) {
      rule(runs_modbus_ ? "counter wraps after 65535" : "counter wraps after 99999");
    }
    counters_[channel] = static_cast<std::uint32_t>(edges % counter_modulus());
  }
}

void Module::clear_latches() {
  latch_high_ = 0;
  latch_low_ = 0;
}

// --- wire.md 6 ---

void Module::restart_host_watchdog() { restart_host_watchdog(kLongestStore); }

void Module::restart_host_watchdog_by_host_ok() { restart_host_watchdog(kLongestSilence); }

void Module::restart_host_watchdog(Time at_most_later) {
  if (!stored_.enabled) {
    return;
  }
  restarted_ = true;
  expiry_ =
      Expiry{now_ + stored_.timeout * kTimeoutUnit, now_ + at_most_later + stored_.timeout * kTimeoutUnit};
}

void Module::replied(Time now) {
  if (restarted_ && expiry_) {
    expiry_->latest = now + stored_.timeout * kTimeoutUnit;
  }
}

void Module::pass(Time now) {
  if (powered_ && expiry_ && now > expiry_->latest) {
    rule(stored_.timed_out ? "host watchdog expires again" : "host watchdog expires");
    outputs_ = stored_.safe;
    stored_.timed_out = true;
    stored_.enabled = false;
    expiry_.reset();
  }
}

// --- whole requests ---

Answer Module::on_request(const Bytes& bytes, Time now) {
  Answer answer;
  if (!powered_) {
    return answer;
  }
  now_ = now;
  restarted_ = false;
  left_open_ = nullptr;
  const Stored before = stored_;
  if (runs_modbus_) {
    answer.reply = modbus_frame(bytes);
  } else {
    // wire.md 3: the first delimiter, or the first lead of a reply, decides. A CR ends any frame.
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const char character = static_cast<char>(bytes[i]);
      // If one of several frames restarts the host watchdog, the restart happens at the end of that frame.
      now_ = now - Time((bytes.size() - 1 - i) * 10 * 1'000'000'000ULL / rate());
      if (!answer.reply.empty()) {
        left_open_ = "the effect of bytes that arrive while the module answers depends on its timing";
      }
      if (framing_ == Framing::Nothing) {
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
          const std::optional<std::string> reply = dcon_frame(frame_);
          if (reply) {
            answer.reply.assign(reply->begin(), reply->end());
          }
        }
        frame_.clear();
      }
    }
  }
  if (!stored_.enabled) {
    expiry_.reset();
  }
  answer.stores = !(stored_ == before);
  answer.left_open = left_open_;
  return answer;
}

}  // namespace ex9000::reference
