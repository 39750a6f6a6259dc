#include "tests/mcu_model/board_bench.hpp"

namespace ex9000::registers {

BoardBench::BoardBench(const Image& of, I2cBehaviour behaviour)
    : image(of),
      memory(EepromChip::kSize, 0xFF),
      eeprom(timeline, pins.at('B', I2cBlock::kClockPin), pins.at('B', I2cBlock::kDataPin), memory),
      line(timeline, net(of.transmit), net(of.driver_enable), net(of.receive)),
      behaviour_(behaviour) {
  for (unsigned channel = 0; channel < image.outputs; ++channel) {
    Net& output = net(image.output_pins.at(channel));
    output.drive(End::Resistor, Drive::WeakLow);
    output.on_change([this, &output] {
      if (output.level() && output_came_on == kNever) {
        output_came_on = timeline.now();
      }
    });
  }
  for (unsigned channel = 0; channel < image.inputs; ++channel) {
    set_input(channel, false);
  }
}

BoardBench::~BoardBench() { stop(); }

void BoardBench::start(ResetCause cause, std::uint32_t causes_before) {
  began = timeline.now();
  output_came_on = kNever;
  mcu.emplace(image.chip(), timeline, pins, behaviour_);
  mcu->system_control.was_reset_by(cause, causes_before);
  mcu->system_control.set_crystal_start(crystal_start);
  mcu->record(record);
  run_.emplace(image, *mcu, timeline);
}

void BoardBench::stop() {
  run_.reset();
  mcu.reset();
}

void BoardBench::power_on() { start(ResetCause::PowerOn, 0); }

void BoardBench::power_off() {
  eeprom.lose_power();
  stop();
}

void BoardBench::reset() { restart(ResetCause::Pin); }

void BoardBench::restart(ResetCause cause) {
  const std::uint32_t causes = powered() ? mcu->system_control.causes() : 0;
  stop();
  start(cause, causes);
}

void BoardBench::run_until(Instant when) {
  if (!powered()) {
    timeline.advance(when);
  }
  while (timeline.now() < when) {
    try {
      run_->run_until(when);
    } catch (const ResetRequest& request) {
      ++resets;
      watchdog_resets += mcu->watchdog_expiries();
      restart(request.cause);
    }
  }
}

std::uint16_t BoardBench::outputs() {
  unsigned result = 0;
  for (unsigned channel = 0; channel < image.outputs; ++channel) {
    result |= (net(image.output_pins.at(channel)).level() ? 1U : 0U) << channel;
  }
  return static_cast<std::uint16_t>(result);
}

void BoardBench::set_input(unsigned channel, bool level) {
  net(image.input_pins.at(channel)).drive(End::Board, level ? Drive::High : Drive::Low);
}

void BoardBench::set_init(bool asserted) {
  net(image.init_switch).drive(End::Board, asserted ? Drive::Low : Drive::Nothing);
}

std::vector<std::uint8_t> BoardBench::exchange(const std::vector<std::uint8_t>& bytes) {
  line.heard.clear();
  line.send(bytes);
  while (line.sending()) {
    run_for(line.bit_time());
  }
  std::size_t had = 0;
  Instant gives_up = timeline.now() + std::chrono::milliseconds(250);
  while (timeline.now() < gives_up) {
    run_for(std::chrono::milliseconds(5));
    if (line.heard.size() != had) {
      had = line.heard.size();
      gives_up = timeline.now() + std::chrono::milliseconds(20);
    }
  }
  std::vector<std::uint8_t> reply;
  for (const LineBench::Heard& each : line.heard) {
    reply.push_back(each.byte);
  }
  return reply;
}

std::string BoardBench::ask(const std::string& command) {
  std::vector<std::uint8_t> bytes(command.begin(), command.end());
  bytes.push_back('\r');
  const std::vector<std::uint8_t> reply = exchange(bytes);
  std::string text(reply.begin(), reply.end());
  if (!text.empty() && text.back() == '\r') {
    text.pop_back();
  }
  return text;
}

}  // namespace ex9000::registers
