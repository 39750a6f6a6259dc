#include "tests/rp2040/pico_target.hpp"

#include <string>

namespace ex9000::pico {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// The image processes a byte and updates its pins in less than this time.
constexpr microseconds kSettling{100};
constexpr microseconds kBetweenEdges{40};
constexpr milliseconds kFlashes{600};  ///< an LED that flashes at 2 Hz changes within this time

}  // namespace

void PicoTarget::start(const Model& model, const Settings* preset) {
  model_ = &model;
  bench_.begin_anew(model, preset);
  bench_.set_baud(baud_);
  bench_.set_format(format_);
  power(true);
}

/// Waits until the driver of the module is off, at most for 12 bits, and then sends. The wait is necessary
/// because `receive` can return in the middle of the first stop bit of a byte, while the driver is still on.
void PicoTarget::send(const play::Bytes& bytes) {
  constexpr std::uint64_t kLongestTail = 12'000'000'000;  // 12 bits at 1 baud, in ns
  bench_.execute("await-release " + std::to_string(kLongestTail / baud_));
  bench_.send(bytes);
}

play::Bytes PicoTarget::listen(std::chrono::nanoseconds time) {
  bench_.run_for(time);
  return bench_.heard();
}

void PicoTarget::set_baud(std::uint32_t rate) {
  baud_ = rate;
  if (model_ != nullptr) {
    bench_.set_baud(rate);
  }
}

void PicoTarget::set_format(LineFormat format) {
  format_ = format;
  if (model_ != nullptr) {
    bench_.set_format(format);
  }
}

void PicoTarget::power(bool on) {
  bench_.power(on);
  if (on) {
    bench_.come_up();
  }
}

void PicoTarget::reset() {
  bench_.reset();
  bench_.come_up();
}

void PicoTarget::set_input(unsigned channel, bool level) {
  if (channel < model_->inputs) {
    bench_.set_input(channel, level);
    bench_.run_for(kBetweenEdges);
  }
}

void PicoTarget::pulse_input(unsigned channel, std::uint32_t count) {
  if (channel < model_->inputs) {
    bench_.pulse_input(channel, count, kBetweenEdges);
  }
}

std::uint16_t PicoTarget::outputs() {
  bench_.run_for(kSettling);
  return bench_.outputs();
}

play::Led PicoTarget::led(play::Led expected) {
  using play::Led;
  if (expected == Led::Flashing && bench_.led_changes(kFlashes)) {
    return Led::Flashing;
  }
  return bench_.led() ? Led::On : Led::Off;
}

void PicoTarget::end() {
  played_ += bench_.now();
  const auto counts = bench_.counts();
  for (const char* wrong : {"lost", "early", "late", "shorts", "timeouts", "requests"}) {
    if (counts.at(wrong) != 0) {
      throw std::runtime_error(std::string(wrong) + ": the count is " + std::to_string(counts.at(wrong)) +
                               "; expected 0");
    }
  }
}

}  // namespace ex9000::pico
