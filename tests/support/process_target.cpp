#include "tests/support/process_target.hpp"

#include <utility>

#include "sim/text/durations.hpp"
#include "sim/text/values.hpp"

namespace ex9000::system {

namespace {

using play::Bytes;

constexpr std::chrono::milliseconds kComingUp{100};

std::string on_off(bool on) { return on ? " on" : " off"; }

}  // namespace

ProcessTarget::ProcessTarget(std::unique_ptr<MasterPort> port, ControlClient& control, std::string line,
                             std::size_t number)
    : port_(std::move(port)), control_(control), line_(std::move(line)), number_(std::to_string(number)) {}

void ProcessTarget::start(const Model& /*model*/, const Settings* /*preset*/) { power(true); }

/// Lets the simulator's time pass, and reads all bytes that the simulator has written to the port. `how` is
/// the end of the command `advance`, for example " quiet".
void ProcessTarget::advance(std::chrono::nanoseconds time, const std::string& how) {
  // Sends both commands together, because each switch between the processes takes time.
  control_.send("advance " + sim::seconds_text(time) + "s" + how + "\nline " + line_ + " sent\n");
  const std::string now = control_.line();
  const std::string sent = control_.line();
  if (now.rfind("ok ", 0) != 0 || sent.rfind("ok ", 0) != 0) {
    throw std::runtime_error(now + "; " + sent);
  }
  for (const std::size_t all = std::stoul(sent.substr(3)); read_ < all;) {
    const Bytes bytes = port_->read();
    read_ += bytes.size();
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }
}

void ProcessTarget::send(const Bytes& bytes) {
  port_->write(bytes);
  const std::chrono::nanoseconds bits = std::chrono::seconds(bits_of_character(format_));
  advance(bits * static_cast<std::int64_t>(bytes.size()) / std::int64_t{baud_},
          " after " + std::to_string(bytes.size()));
}

Bytes ProcessTarget::take_heard() { return std::exchange(heard_, {}); }

Bytes ProcessTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  for (std::size_t had = heard_.size(); heard_.size() < count; had = heard_.size()) {
    advance(patience, " quiet");
    if (heard_.size() == had) {
      break;
    }
  }
  Bytes bytes = take_heard();
  if (bytes.size() > count) {
    heard_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(count), bytes.end());
    bytes.resize(count);
  }
  return bytes;
}

Bytes ProcessTarget::listen(std::chrono::nanoseconds time) {
  advance(time);
  return take_heard();
}

void ProcessTarget::set_baud(std::uint32_t rate) {
  baud_ = rate;
  if (!port_->set_baud(rate)) {
    control_.ok("line " + line_ + " baud " + std::to_string(rate));
  }
}

void ProcessTarget::set_format(LineFormat format) {
  format_ = format;
  control_.ok("line " + line_ + " format " + sim::line_format_text(format));
}

std::string ProcessTarget::control(const std::string& command) {
  return control_.ok(number_ + " " + command);
}

void ProcessTarget::power(bool on) {
  control("power" + on_off(on));
  if (on) {
    advance(kComingUp);
  }
}

void ProcessTarget::reset() {
  control("reset");
  advance(kComingUp);
}

void ProcessTarget::set_init(bool asserted) { control("init" + on_off(asserted)); }

void ProcessTarget::set_input(unsigned channel, bool level) {
  control("input " + std::to_string(channel) + on_off(level));
}

void ProcessTarget::pulse_input(unsigned channel, std::uint32_t count) {
  control("pulse " + std::to_string(channel) + " x" + std::to_string(count));
}

std::uint16_t ProcessTarget::outputs() {
  return static_cast<std::uint16_t>(std::stoul(control("outputs"), nullptr, 16));
}

play::Led ProcessTarget::led(play::Led /*expected*/) {
  const std::string shows = control("led");
  if (shows == "flashing") {
    return play::Led::Flashing;
  }
  return shows == "on" ? play::Led::On : play::Led::Off;
}

/// Switches the module off, so that it uses no processor time while the next transcript is played.
void ProcessTarget::end() { power(false); }

}  // namespace ex9000::system
