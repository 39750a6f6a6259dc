#include "tests/qemu/emulated_board.hpp"

#include <stdexcept>

#include "sim/virtual_line/wires/module.hpp"
#include "tests/qemu/signals.hpp"
#include "tests/qemu/uart_registers.hpp"
#include "tests/support/in_repository.hpp"
#include "tests/support/line_control.hpp"

namespace ex9000::rig {

namespace {

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

std::string image_of(const Model& model) {
  return in_repository(EX9000_IMAGES "/" + std::string(model.designation) + ".elf");
}

EmulatedBoard::EmulatedBoard(const Model& model, const Settings* settings) : model_(model) {
  store(settings);
}

void EmulatedBoard::store(const Settings* settings) {
  set_memory(text_of(sim::SimulatedModule::memory_image(
      model_, settings != nullptr ? *settings : Settings::factory(model_))));
}

void EmulatedBoard::renew(const Settings* settings) {
  levels_ = {};
  init_asserted_ = false;
  store(settings);
  supply(true);
}

void EmulatedBoard::supply(bool on) {
  powered_ = on;
  if (!on) {
    return;
  }
  if (!emulator_) {
    emulator_.emplace(image_of(model_), directory_ / "memory");
    set_pin_levels();
  } else {
    pull_reset();
  }
  fill_ram();
}

void EmulatedBoard::kill() {
  powered_ = false;
  emulator_.reset();
}

/// Fills RAM with the byte 0xA5, because an image must not depend on the content of RAM after power-on.
void EmulatedBoard::fill_ram() {
  constexpr std::uint32_t kRam = 0x2000'0000;
  constexpr std::uint32_t kRamSize = 0x1'0000;
  constexpr std::uint8_t kNoise = 0xA5;
  emulator_->bus().fill(kRam, kRamSize, kNoise);
}

void EmulatedBoard::pull_reset() {
  emulator_->reset();
  set_pin_levels();
  while (!emulator_->uart().receive(std::chrono::nanoseconds(0)).empty()) {
  }
}

void EmulatedBoard::set_pin_levels() {
  set_pin_level(emulator_->bus(), board::kInitSwitch, !init_asserted_);
  for (unsigned channel = 0; channel < model_.inputs; ++channel) {
    set_pin_level(emulator_->bus(), input_pin(channel), levels_[channel]);
  }
}

void EmulatedBoard::set_init(bool asserted) {
  init_asserted_ = asserted;
  if (powered()) {
    set_pin_level(emulator_->bus(), board::kInitSwitch, !asserted);
  }
}

void EmulatedBoard::set_level(unsigned channel, bool level) {
  levels_.at(channel) = level;
  if (powered()) {
    set_pin_level(emulator_->bus(), input_pin(channel), level);
  }
}

std::uint16_t EmulatedBoard::outputs() {
  if (!powered()) {
    return 0;
  }
  std::vector<std::uint32_t> pins;
  for (unsigned channel = 0; channel < model_.outputs; ++channel) {
    pins.push_back(data_address(output_pin(channel)));
  }
  unsigned channels = 0;
  unsigned channel = 0;
  for (const std::uint32_t level : emulator_->bus().read(pins)) {
    channels |= level != 0 ? 1U << channel : 0U;
    ++channel;
  }
  return static_cast<std::uint16_t>(channels);
}

bool EmulatedBoard::led_lit() { return powered() && level_of(emulator_->bus(), board::kStatusLed); }

hal::SerialMode EmulatedBoard::mode() {
  if (!powered()) {
    return {};
  }
  const std::vector<std::uint32_t> uart =
      emulator_->bus().read({kUart0 + kUartControl, kUart0 + kUartIntegerDivisor,
                             kUart0 + kUartFractionalDivisor, kUart0 + kUartLineControl});
  const std::uint32_t divisor = uart[1] * 64 + uart[2];
  if ((uart[0] & kUartEnabled) == 0 || divisor == 0) {
    return {};
  }
  const auto format = line_format_of(uart[3]);
  if (!format || (uart[3] & kUartFifosOn) != 0) {
    throw std::runtime_error("UART0: the line control register is " + std::to_string(uart[3]) +
                             " (decimal); expected 8N1, 8N2, 8E1 or 8O1, and the FIFOs off");
  }
  return {board::kClock.frequency() / 16 * 64 / divisor, *format};
}

}  // namespace ex9000::rig
