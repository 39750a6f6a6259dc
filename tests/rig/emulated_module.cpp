#include "tests/rig/emulated_module.hpp"

#include <stdexcept>
#include <thread>

#include "sim/module.hpp"
#include "tests/rig/board_pins.hpp"

namespace ex9000::rig {

namespace {

/// Of the LM3S6965 and its emulation.
constexpr std::uint32_t kGpioData = 0x3FC;  ///< all eight pins
constexpr std::uint32_t kGpioMaskedStatus = 0x418;
constexpr std::uint32_t kUart0 = 0x4000'C000;
constexpr std::uint32_t kUartIntegerDivisor = 0x24;
constexpr std::uint32_t kUartFractionalDivisor = 0x28;
constexpr std::uint32_t kUartControl = 0x30;
constexpr std::uint32_t kUartEnabled = 1;
constexpr std::uint32_t kSystemClock = 50'000'000;

std::uint32_t address_of(char port) {
  constexpr std::array<std::uint32_t, 7> kPorts{0x4000'4000, 0x4000'5000, 0x4000'6000, 0x4000'7000,
                                                0x4002'4000, 0x4002'5000, 0x4002'6000};
  return kPorts.at(static_cast<std::size_t>(port - 'A'));
}

std::string path_of(char port) {
  constexpr int kPortA = 8;
  return "/machine/unattached/device[" + std::to_string(kPortA + (port - 'A')) + "]";
}

bool level_of(QtestClient& bus, Pin pin) {
  return (bus.read(address_of(pin.port) + kGpioData) >> pin.number & 1U) != 0;
}

/// Returns when the image has cleared the edge's flag, or does not ask for it. A level that changed before
/// would be lost, for the emulator takes no time between two.
void change(QtestClient& bus, Pin pin, bool level) {
  constexpr std::chrono::seconds kPatience{20};
  const std::uint32_t flags = address_of(pin.port) + kGpioMaskedStatus;
  const std::uint32_t flag = 1U << pin.number;
  if ((bus.set_input_and_read(path_of(pin.port), pin.number, level, flags) & flag) == 0) {
    return;
  }
  const auto gives_up = std::chrono::steady_clock::now() + kPatience;
  while ((bus.read(flags) & flag) != 0) {
    if (std::chrono::steady_clock::now() > gives_up) {
      throw std::runtime_error("the image does not take an edge");
    }
  }
}

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

std::string image_of(const Model& model) {
  return std::string(EX9000_IMAGES) + "/" + std::string(model.designation) + ".elf";
}

EmulatedModule::EmulatedModule(const Model& model, const Settings* settings) : model_(model) {
  set_memory(text_of(
      sim::SimulatedModule::memory_image(model, settings != nullptr ? *settings : Settings::factory(model))));
}

void EmulatedModule::power(bool on) {
  if (on == powered()) {
    return;
  }
  if (!on) {
    emulator_.reset();
    return;
  }
  emulator_.emplace(image_of(model_), directory_ / "memory");
  give_levels();
  emulator_->run();
}

void EmulatedModule::reset() {
  if (powered()) {
    emulator_->halt();
    emulator_->reset();
    give_levels();
    emulator_->run();
  }
}

void EmulatedModule::give_levels() {
  emulator_->bus().set_input(path_of(kInitSwitch.port), kInitSwitch.number, !init_asserted_);
  for (unsigned channel = 0; channel < model_.inputs; ++channel) {
    emulator_->bus().set_input(path_of(kInputs[channel].port), kInputs[channel].number, levels_[channel]);
  }
}

void EmulatedModule::set_init(bool asserted) {
  init_asserted_ = asserted;
  if (powered()) {
    emulator_->bus().set_input(path_of(kInitSwitch.port), kInitSwitch.number, !asserted);
  }
}

void EmulatedModule::set_input(unsigned channel, bool level) {
  if (channel >= model_.inputs) {
    return;
  }
  levels_.at(channel) = level;
  if (powered()) {
    change(emulator_->bus(), kInputs[channel], level);
  }
}

void EmulatedModule::pulse_input(unsigned channel, std::uint32_t count) {
  if (channel >= model_.inputs || !powered()) {
    return;
  }
  const bool level = levels_.at(channel);
  for (std::uint32_t i = 0; i < count; ++i) {
    change(emulator_->bus(), kInputs[channel], !level);
    change(emulator_->bus(), kInputs[channel], level);
  }
}

std::uint16_t EmulatedModule::outputs() {
  unsigned channels = 0;
  for (unsigned channel = 0; channel < model_.outputs && powered(); ++channel) {
    channels |= level_of(emulator_->bus(), kOutputs[channel]) ? 1U << channel : 0U;
  }
  return static_cast<std::uint16_t>(channels);
}

bool EmulatedModule::led_lit() { return powered() && level_of(emulator_->bus(), kLed); }

std::uint32_t EmulatedModule::baud() {
  if (!powered() || (emulator_->bus().read(kUart0 + kUartControl) & kUartEnabled) == 0) {
    return 0;
  }
  const std::uint32_t divisor = emulator_->bus().read(kUart0 + kUartIntegerDivisor) * 64 +
                                emulator_->bus().read(kUart0 + kUartFractionalDivisor);
  return divisor == 0 ? 0 : kSystemClock / 16 * 64 / divisor;
}

void EmulatedModule::send(const std::vector<std::uint8_t>& bytes) {
  if (powered()) {
    emulator_->uart().send(bytes.data(), bytes.size());
  }
}

std::vector<std::uint8_t> EmulatedModule::hear(std::chrono::nanoseconds patience) {
  if (powered()) {
    return emulator_->uart().receive(patience);
  }
  std::this_thread::sleep_for(patience);
  return {};
}

}  // namespace ex9000::rig
