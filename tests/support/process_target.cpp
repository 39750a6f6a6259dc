#include "tests/support/process_target.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::system {

namespace {

using play::Bytes;

constexpr std::chrono::milliseconds kComingUp{100};
/// A simulator on a busy machine hears a byte this much later than it was written.
constexpr std::chrono::milliseconds kHostLatency{20};
/// And may keep an answer waiting this much longer than a module would: only a missing one costs it.
constexpr std::chrono::seconds kPatience{3};

std::string on_off(bool on) { return on ? " on" : " off"; }

}  // namespace

ProcessTarget::ProcessTarget(const std::string& tty, const std::string& control, std::size_t number)
    : number_(std::to_string(number)), terminal_(tty, 9600), control_(control) {}

void ProcessTarget::start(const Model& /*model*/, const Settings* /*preset*/) {}

void ProcessTarget::send(const Bytes& bytes) {
  terminal_.write(bytes);
  constexpr std::chrono::nanoseconds kCharacterBits{10'000'000'000};
  line_free_ = std::max(line_free_, Clock::now()) +
               kCharacterBits * static_cast<std::int64_t>(bytes.size()) / std::int64_t{baud_};
}

void ProcessTarget::hear_until(Clock::time_point when) {
  for (auto now = Clock::now(); now < when; now = Clock::now()) {
    const Bytes bytes = terminal_.read(when - now);
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }
}

Bytes ProcessTarget::take_heard() { return std::exchange(heard_, {}); }

Bytes ProcessTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  Clock::time_point gives_up = std::max(line_free_, Clock::now()) + patience + kPatience;
  while (heard_.size() < count && Clock::now() < gives_up) {
    const Bytes bytes = terminal_.read(gives_up - Clock::now());
    if (bytes.empty()) {
      break;
    }
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
    gives_up = Clock::now() + patience + kPatience;
  }
  Bytes bytes = take_heard();
  if (bytes.size() > count) {
    heard_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(count), bytes.end());
    bytes.resize(count);
  }
  return bytes;
}

Bytes ProcessTarget::listen(std::chrono::nanoseconds time) {
  hear_until(std::max(line_free_, Clock::now()) + time);
  return take_heard();
}

void ProcessTarget::set_baud(std::uint32_t rate) {
  baud_ = rate;
  terminal_.set_baud(rate);
}

std::string ProcessTarget::control(const std::string& command) {
  if (Clock::now() < line_free_ + kHostLatency) {
    hear_until(line_free_ + kHostLatency);
  }
  return control_.ok(number_ + " " + command);
}

void ProcessTarget::power(bool on) {
  control("power" + on_off(on));
  if (on) {
    hear_until(Clock::now() + kComingUp);
  }
}

void ProcessTarget::reset() {
  control("reset");
  hear_until(Clock::now() + kComingUp);
}

void ProcessTarget::set_init(bool asserted) { control("init" + on_off(asserted)); }

void ProcessTarget::set_input(unsigned channel, bool level) {
  control("input " + std::to_string(channel) + on_off(level));
}

void ProcessTarget::pulse_input(unsigned channel, std::uint32_t count) {
  control("pulse " + std::to_string(channel) + " " + std::to_string(count));
}

std::uint16_t ProcessTarget::outputs() {
  return static_cast<std::uint16_t>(std::stoul(control("outputs"), nullptr, 16));
}

play::step::Led::Shows ProcessTarget::led(play::step::Led::Shows /*expected*/) {
  const std::string shows = control("led");
  if (shows == "flashing") {
    return play::step::Led::Shows::Flashing;
  }
  return shows == "on" ? play::step::Led::Shows::On : play::step::Led::Shows::Off;
}

}  // namespace ex9000::system
