#include "sim/play/bus_target.hpp"

#include <algorithm>
#include <utility>

#include "sim/control/control.hpp"
#include "sim/eeprom_file.hpp"
#include "sim/line_of_setup.hpp"

namespace ex9000::play {

namespace {

constexpr std::chrono::milliseconds kComingUp{100};

}  // namespace

BusTarget::BusTarget(const sim::Setup& setup, Onlooker* onlooker) : onlooker_(onlooker) {
  for (const sim::LineSetup& line : setup.lines) {
    add_line(line, setup.seed + lines_.size());
  }
}

void BusTarget::start(const Model& model, const Settings* preset) {
  sim::LineSetup setup;
  setup.modules.push_back(sim::factory_fresh(model));
  if (preset != nullptr) {
    setup.modules[0].settings = *preset;
  }
  add_line(setup, 1);
}

void BusTarget::add_line(const sim::LineSetup& setup, std::uint64_t seed) {
  const std::size_t index = lines_.size();
  names_.push_back(setup.name);
  heard_.emplace_back();
  lines_.push_back(sim::make_line(
      setup, [this, index](std::uint8_t byte, ByteStatus /*status*/) { heard_[index].push_back(byte); }));
  sim::Line& line = *lines_.back();
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (!setup.modules[i].eeprom.empty()) {
      const sim::EepromFile file(setup.modules[i].eeprom);
      if (file.found()) {
        line.module(i).memory().contents() = *file.found();
      }
    }
  }
  line.come_up();
  line.master().set_baud(setup.baud.value_or(line.module(0).baud()));
  line.expect_trouble(seed, onlooker_ == nullptr ? nullptr : onlooker_->joins(line, setup.name));
  sim::begin_programs(line, setup);
}

void BusTarget::run_until(sim::VirtualTime until) {
  for (const auto& line : lines_) {
    line->bus().run_until(until);
  }
  if (onlooker_ != nullptr) {
    onlooker_->reached(until);
  }
}

void BusTarget::send(const Bytes& bytes) {
  sim::Master& master = chosen().master();
  master.send(bytes.data(), bytes.size());
  while (master.sending()) {
    run_until(chosen().bus().next());
  }
}

Bytes BusTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  Bytes& heard = heard_[line_];
  std::size_t had = heard.size();
  sim::VirtualTime gives_up = now() + patience;
  while (heard.size() < count && chosen().bus().next() <= gives_up) {
    run_until(chosen().bus().next());
    if (heard.size() != had) {
      had = heard.size();
      gives_up = now() + patience;
    }
  }
  return std::exchange(heard, {});
}

Bytes BusTarget::listen(std::chrono::nanoseconds time) {
  run_until(now() + time);
  return std::exchange(heard_[line_], {});
}

void BusTarget::power(bool on) {
  module().power(on);
  if (on) {
    run_until(now() + kComingUp);
  }
}

void BusTarget::reset() {
  module().reset();
  run_until(now() + kComingUp);
}

void BusTarget::want_input(unsigned channel) {
  if (channel >= module().model().inputs) {
    throw std::runtime_error("the " + std::string(module().model().designation) + " has no such input");
  }
}

void BusTarget::set_input(unsigned channel, bool level) {
  want_input(channel);
  module().set_input(channel, level);
}

void BusTarget::pulse_input(unsigned channel, std::uint32_t count) {
  want_input(channel);
  module().pulse_input(channel, count);
}

step::Led::Shows BusTarget::led(step::Led::Shows /*expected*/) {
  // No time passes: the steps around this one measure it. That the pin flashes as the pattern says is a unit
  // test.
  if (module().powered() && module().module().led_pattern() == StatusLed::Pattern::HostTimeout) {
    return step::Led::Shows::Flashing;
  }
  return module().led_lit() ? step::Led::Shows::On : step::Led::Shows::Off;
}

void BusTarget::choose_module(std::size_t position) {
  std::size_t index = position;
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    if (index < lines_[line]->size()) {
      line_ = line;
      module_ = index;
      return;
    }
    index -= lines_[line]->size();
  }
  throw std::runtime_error("no module " + std::to_string(position + 1) + "; there are 1 to " +
                           std::to_string(position - index));
}

void BusTarget::choose_line(const std::string& name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) {
    throw std::runtime_error("no line of this name");
  }
  line_ = static_cast<std::size_t>(found - names_.begin());
  module_ = 0;
}

void BusTarget::trouble(const std::string& command) {
  sim::Control control({{"", chosen()}});
  const sim::Control::Reply reply = control.carry_out(command);
  if (reply.text.rfind("ok", 0) != 0) {
    throw std::runtime_error(reply.text);
  }
}

}  // namespace ex9000::play
