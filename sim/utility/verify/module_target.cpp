#include "sim/utility/verify/module_target.hpp"

#include <utility>

#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::utility {

void ModuleTarget::throw_problem() const {
  if (problem_ != nullptr) {
    std::rethrow_exception(problem_);
  }
}

std::string ModuleTarget::ask(const std::string& request) {
  return noting([&] { return rig_.ask(request); });
}

void ModuleTarget::hear_until(Time end) {
  noting([&] {
    for (Time left{}; (left = end - line_.connection().now()) > Time(0);) {
      const Data more = line_.connection().receive(left);
      heard_.insert(heard_.end(), more.begin(), more.end());
    }
  });
}

void ModuleTarget::set_mode(hal::SerialMode mode) {
  noting([&] {
    if (!line_.has_modes() && mode != line_.mode()) {
      throw NotVerified("the port cannot change to " + sim::mode_text(mode.baud, mode.format));
    }
    try {
      line_.set_mode(mode);
    } catch (const std::invalid_argument& error) {
      throw NotVerified(error.what());
    }
    mode_ = mode;
  });
}

void ModuleTarget::start(const Model& model, const Settings* preset) {
  problem_ = nullptr;
  init_mode_.enter();
  Settings wanted = preset == nullptr ? Settings::factory(model) : *preset;
  wanted.serial_number = serial_number_;
  init_mode_.write(model, wanted);
  switch_inputs_off(model);
  init_mode_.leave();
  heard_.clear();
}

void ModuleTarget::switch_inputs_off(const Model& model) {
  try {
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      if ((inputs_ >> channel & 1U) != 0) {
        set_input(channel, false);
      }
    }
  } catch (const NotVerified&) {
    if (!init_mode_.inputs_are_off(model)) {  // perhaps nothing is connected to them
      throw;
    }
    problem_ = nullptr;
  }
}

void ModuleTarget::send(const play::Bytes& bytes) {
  Connection& connection = line_.connection();
  const Time bits = std::chrono::seconds(bits_of_character(mode_.format));
  const Time end =
      connection.now() + bits * static_cast<std::int64_t>(bytes.size()) / std::int64_t{mode_.baud};
  noting([&] { connection.send(bytes); });
  hear_until(end);
}

play::Bytes ModuleTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  noting([&] {
    while (heard_.size() < count) {
      const Data more = line_.connection().receive(patience + latency_);
      if (more.empty()) {
        break;
      }
      heard_.insert(heard_.end(), more.begin(), more.end());
    }
  });
  play::Bytes bytes = std::exchange(heard_, {});
  if (bytes.size() > count) {
    heard_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(count), bytes.end());
    bytes.resize(count);
  }
  return bytes;
}

play::Bytes ModuleTarget::listen(std::chrono::nanoseconds time) {
  hear_until(line_.connection().now() + time);
  return std::exchange(heard_, {});
}

void ModuleTarget::power(bool on) {
  ask(std::string("power ") + sim::on_off_text(on));
  if (on) {
    hear_until(line_.connection().now() + InitMode::kStart);
  }
}

void ModuleTarget::reset() {
  ask("reset");
  hear_until(line_.connection().now() + InitMode::kStart);
}

void ModuleTarget::set_init(bool asserted) { ask("init " + sim::on_off_text(asserted)); }

void ModuleTarget::set_input(unsigned channel, bool level) {
  ask("input " + std::to_string(channel) + " " + sim::on_off_text(level));
  const unsigned bit = 1U << channel;
  inputs_ = level ? inputs_ | bit : inputs_ & ~bit;
}

void ModuleTarget::pulse_input(unsigned channel, std::uint32_t count) {
  ask("pulse " + std::to_string(channel) + " x" + std::to_string(count));
}

std::uint16_t ModuleTarget::outputs() {
  const std::string answer = ask("outputs");
  return noting(
      [&] { return sim::with_place("--rig: outputs: ", [&] { return sim::parse_hex_word(answer); }); });
}

play::Led ModuleTarget::led(play::Led /*expected*/) {
  const std::string answer = ask("led");
  for (const play::Led led : {play::Led::On, play::Led::Off, play::Led::Flashing}) {
    if (answer == play::led_text(led)) {
      return led;
    }
  }
  return noting(
      [&]() -> play::Led { sim::unavailable("--rig: led: '" + answer + "': expected on, off or flashing"); });
}

/// What is still on its way through the port.
void ModuleTarget::end() {
  const play::Bytes more = listen(latency_);
  if (!more.empty()) {
    throw std::runtime_error("expected nothing, received " + sim::hex_text(more, " "));
  }
}

}  // namespace ex9000::utility
