#include "tests/rig/image_target.hpp"

#include <chrono>
#include <utility>

#include "tests/rig/wrong_rate.hpp"

namespace ex9000::rig {

namespace {

using runner::Bytes;
using runner::step::Led;

constexpr std::chrono::milliseconds kComingUp{100};
/// An image on a busy host has done what a frame asks for this much later than it was written.
constexpr std::chrono::milliseconds kHostLatency{20};
/// And may keep an answer waiting this much longer than a module would: only a missing one costs it.
constexpr std::chrono::seconds kPatience{3};
/// An answer may be on its way before the pins show what it says.
constexpr std::chrono::milliseconds kTurn{3};
constexpr std::chrono::milliseconds kLook{5};
/// The longer of a flashing LED's phases, and what the host adds to it.
constexpr std::chrono::milliseconds kFlashing{300};

}  // namespace

void ImageTarget::start(const Model& model, const Settings* preset) {
  if (!module_ || &module_->model() != &model) {
    module_.emplace(model, nullptr);
  }
  heard_.clear();
  settled_ = {};
  module_->begin_anew(preset);
  // Unlike a power-on in the middle of a transcript, this one is not where anything is measured from.
  const Clock::time_point gives_up = Clock::now() + kPatience;
  while (module_->baud() == 0 && Clock::now() < gives_up) {
    hear_until(Clock::now() + kLook);
  }
}

void ImageTarget::send(const Bytes& bytes) {
  module_->send(heard_at_rate(bytes, baud_, module_->baud()));
  settled_ = Clock::now() + kHostLatency;
}

void ImageTarget::hear(std::chrono::nanoseconds patience) {
  Bytes bytes = module_->hear(patience);
  if (!bytes.empty()) {
    bytes = heard_at_rate(bytes, module_->baud(), baud_);
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }
}

void ImageTarget::hear_until(Clock::time_point when) {
  for (auto now = Clock::now(); now < when; now = Clock::now()) {
    hear(when - now);
  }
}

void ImageTarget::hear_for(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kShort{10};
  constexpr int kSlowest = 10;  // times slower than the host's clock
  if (time < kShort || !module_->powered()) {
    hear_until(Clock::now() + time);
    return;
  }
  const Clock::time_point gives_up = Clock::now() + kPatience + kSlowest * time;
  const std::chrono::microseconds until = module_->time() + time;
  for (auto now = module_->time(); now < until && Clock::now() < gives_up; now = module_->time()) {
    hear_until(Clock::now() + (until - now));
  }
}

void ImageTarget::come_up() {
  const Clock::time_point gives_up = Clock::now() + kPatience;
  while (module_->baud() == 0 && Clock::now() < gives_up) {
    hear_until(Clock::now() + kLook);
  }
  const std::chrono::microseconds now = module_->time();
  if (now < kComingUp) {
    hear_for(std::chrono::duration_cast<std::chrono::milliseconds>(kComingUp - now));
  }
}

Bytes ImageTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  Clock::time_point gives_up = Clock::now() + patience + kPatience;
  while (heard_.size() < count && Clock::now() < gives_up) {
    const std::size_t had = heard_.size();
    hear(gives_up - Clock::now());
    if (heard_.size() != had) {
      gives_up = Clock::now() + patience + kPatience;
    }
  }
  settled_ = Clock::now() + kTurn;
  Bytes bytes = std::exchange(heard_, {});
  if (bytes.size() > count) {
    heard_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(count), bytes.end());
    bytes.resize(count);
  }
  return bytes;
}

Bytes ImageTarget::listen(std::chrono::milliseconds time) {
  hear_for(time);
  return std::exchange(heard_, {});
}

EmulatedModule& ImageTarget::settled() {
  hear_until(settled_);
  return *module_;
}

void ImageTarget::power(bool on) {
  settled().power(on);
  if (on) {
    come_up();
  }
}

void ImageTarget::reset() {
  settled().reset();
  if (module_->powered()) {
    come_up();
  }
}

void ImageTarget::set_init(bool asserted) { settled().set_init(asserted); }

void ImageTarget::set_input(unsigned channel, bool level) { settled().set_input(channel, level); }

void ImageTarget::pulse_input(unsigned channel, std::uint32_t count) {
  settled().pulse_input(channel, count);
}

std::uint16_t ImageTarget::outputs() { return settled().outputs(); }

/// A lamp that is lit may be about to go dark, if it flashes. To see it takes time that the steps around this
/// one measure, so it is taken only where it is expected to.
Led::Shows ImageTarget::led(Led::Shows expected) {
  const bool lit = settled().led_lit();
  if (!module_->powered()) {
    return Led::Shows::Off;
  }
  if (lit && expected == Led::Shows::On) {
    return Led::Shows::On;
  }
  const std::chrono::microseconds gives_up = module_->time() + kFlashing;
  while (module_->time() < gives_up) {
    hear_until(Clock::now() + kLook);
    if (module_->led_lit() != lit) {
      return Led::Shows::Flashing;
    }
  }
  return lit ? Led::Shows::On : Led::Shows::Off;
}

}  // namespace ex9000::rig
