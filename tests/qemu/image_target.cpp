#include "tests/qemu/image_target.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace ex9000::rig {

namespace {

using play::Bytes;
using play::Led;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kComingUp{100};
/// The image processes a byte and updates its pins in less than this time.
constexpr milliseconds kSettling{1};
constexpr milliseconds kSlice{2};
/// Longer than each phase of an LED that flashes at 2 Hz after a timeout.
constexpr milliseconds kFlashing{300};
constexpr milliseconds kLook{10};

}  // namespace

void ImageTarget::start(const Model& model, const Settings* preset) {
  module_ =
      &modules_.emplace(std::piecewise_construct, std::forward_as_tuple(&model), std::forward_as_tuple(model))
           .first->second;
  heard_.clear();
  settled_ = nanoseconds(0);
  module_->begin_anew(preset);
  module_->run_for(kComingUp);
}

void ImageTarget::send(const Bytes& bytes) {
  module_->send(bytes, mode_);
  settled_ = module_->now() + kSettling;
}

void ImageTarget::hear() {
  const Bytes bytes = module_->hear(mode_);
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
}

Bytes ImageTarget::receive(std::size_t count, milliseconds patience) {
  hear();
  nanoseconds gives_up = module_->now() + patience;
  while (heard_.size() < count && module_->now() < gives_up) {
    const std::size_t had = heard_.size();
    module_->run_for(std::min<nanoseconds>(kSlice, gives_up - module_->now()));
    hear();
    if (heard_.size() != had) {
      gives_up = module_->now() + patience;
    }
  }
  settled_ = module_->now() + kSettling;
  Bytes bytes = std::exchange(heard_, {});
  if (bytes.size() > count) {
    heard_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(count), bytes.end());
    bytes.resize(count);
  }
  return bytes;
}

Bytes ImageTarget::listen(std::chrono::nanoseconds time) {
  module_->run_for(time);
  hear();
  return std::exchange(heard_, {});
}

TimedModule& ImageTarget::settled() {
  if (module_->now() < settled_) {
    module_->run_for(settled_ - module_->now());
  }
  hear();
  return *module_;
}

void ImageTarget::power(bool on) {
  settled().power(on);
  if (on) {
    module_->run_for(kComingUp);
  }
}

void ImageTarget::reset() {
  settled().reset();
  module_->run_for(kComingUp);
}

void ImageTarget::set_init(bool asserted) { settled().set_init(asserted); }

void ImageTarget::set_input(unsigned channel, bool level) { settled().set_input(channel, level); }

void ImageTarget::pulse_input(unsigned channel, std::uint32_t count) {
  settled().pulse_input(channel, count);
}

std::uint16_t ImageTarget::outputs() { return settled().outputs(); }

Led ImageTarget::led(Led expected) {
  const bool lit = settled().led_lit();
  if (!module_->powered()) {
    return Led::Off;
  }
  if (lit && expected == Led::On) {
    module_->assume_led_on();
    return Led::On;
  }
  const nanoseconds gives_up = module_->now() + kFlashing;
  while (module_->now() < gives_up) {
    module_->run_for(kLook);
    if (module_->led_lit() != lit) {
      return Led::Flashing;
    }
  }
  return lit ? Led::On : Led::Off;
}

}  // namespace ex9000::rig
