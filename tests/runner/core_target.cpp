#include "tests/runner/core_target.hpp"

#include <utility>

namespace ex9000::runner {

namespace {

constexpr std::chrono::milliseconds kComingUp{100};
constexpr std::uint32_t kAnyRate = 9600;

}  // namespace

void CoreTarget::start(const Model& model, const Settings* preset) {
  master_.emplace(bus_, kAnyRate,
                  [this](std::uint8_t byte, ByteStatus /*status*/) { heard_.push_back(byte); });
  module_.emplace(bus_, model);
  if (preset != nullptr) {
    module_->store(*preset);
  }
  power(true);
}

void CoreTarget::send(const Bytes& bytes) {
  sent_.insert(sent_.end(), bytes.begin(), bytes.end());
  master_->send(bytes.data(), bytes.size());
  while (master_->sending()) {
    bus_.run_until(bus_.next());
  }
}

Bytes CoreTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  std::size_t had = heard_.size();
  sim::VirtualTime gives_up = clock_.virtual_now() + patience;
  while (heard_.size() < count && bus_.next() <= gives_up) {
    bus_.run_until(bus_.next());
    if (heard_.size() != had) {
      had = heard_.size();
      gives_up = clock_.virtual_now() + patience;
    }
  }
  return take_heard();
}

Bytes CoreTarget::listen(std::chrono::milliseconds time) {
  bus_.run_for(time);
  return take_heard();
}

Bytes CoreTarget::take_heard() {
  Bytes heard = std::exchange(heard_, {});
  note_coverage(heard);
  return heard;
}

void CoreTarget::set_baud(std::uint32_t rate) { master_->set_baud(rate); }

void CoreTarget::power(bool on) {
  module_->power(on);
  if (on) {
    bus_.run_for(kComingUp);
  }
}

void CoreTarget::reset() {
  module_->reset();
  bus_.run_for(kComingUp);
}

step::Led::Shows CoreTarget::led(step::Led::Shows /*expected*/) {
  // No time passes: the steps around this one measure it. That the pin flashes as the pattern says is a unit
  // test.
  if (module_->powered() && module_->module().led_pattern() == StatusLed::Pattern::HostTimeout) {
    return step::Led::Shows::Flashing;
  }
  return module_->led_lit() ? step::Led::Shows::On : step::Led::Shows::Off;
}

void CoreTarget::note_coverage(const Bytes& heard) {
  if (coverage_ != nullptr && !sent_.empty() && module_->powered() && module_->baud() == master_->baud()) {
    coverage_->note(module_->module(), sent_, heard);
  }
  sent_.clear();
}

}  // namespace ex9000::runner
