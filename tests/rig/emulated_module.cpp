#include "tests/rig/emulated_module.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "sim/module.hpp"
#include "tests/rig/board_pins.hpp"

namespace ex9000::rig {

namespace {

/// Of the LM3S6965 and its emulation.
constexpr std::uint32_t kGpioData = 0x3FC;  ///< all eight pins
constexpr std::uint32_t kInterruptState = 0xE000'ED04;
constexpr std::uint32_t kRam = 0x2000'0000;
constexpr std::uint32_t kRamSize = 0x1'0000;
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

/// Returns when the image has served the edge's interrupt, or any other that is there; a level that changed
/// before would not be seen as it was, for the emulator takes no time between two.
void change(QtestClient& bus, Pin pin, bool level) {
  constexpr std::chrono::seconds kPatience{20};
  constexpr std::uint32_t kAnyActiveOrPending = 0x0040'01FF;
  bus.set_input(path_of(pin.port), pin.number, level);
  const auto gives_up = std::chrono::steady_clock::now() + kPatience;
  while ((bus.read(kInterruptState) & kAnyActiveOrPending) != 0) {
    if (std::chrono::steady_clock::now() > gives_up) {
      throw std::runtime_error("the image does not take an edge");
    }
  }
}

std::uint32_t word_of(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8U |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16U | static_cast<std::uint32_t>(bytes[at + 3]) << 24U;
}

/// Where a running image counts the microseconds of its ticks: the one word that is made of milliseconds
/// whenever it is looked at, and goes on by as many as have passed.
std::uint32_t find_clock(QtestClient& bus) {
  constexpr std::uint32_t kUsed = 4096;
  constexpr std::uint32_t kMillisecond = 1000;
  constexpr std::uint32_t kAtLeast = 5 * kMillisecond;
  constexpr std::uint32_t kAtMost = 1000 * kMillisecond;
  constexpr unsigned kLooks = 4;
  std::vector<std::uint32_t> found;
  for (std::uint32_t at = 0; at < kUsed; at += 4) {
    found.push_back(at);
  }
  std::vector<std::uint8_t> before = bus.read(kRam, kUsed);
  for (unsigned look = 0; look < kLooks; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::vector<std::uint8_t> now = bus.read(kRam, kUsed);
    const auto stands_still = [&](std::uint32_t at) {
      const std::uint32_t passed = word_of(now, at) - word_of(before, at);
      return word_of(now, at) % kMillisecond != 0 || passed < kAtLeast || passed > kAtMost;
    };
    found.erase(std::remove_if(found.begin(), found.end(), stands_still), found.end());
    before = now;
  }
  if (found.size() != 1) {
    throw std::runtime_error("the image's clock is not found");
  }
  return kRam + found[0];
}

/// Sought once an image.
std::uint32_t clock_of(const Model& model, QtestClient& bus) {
  static std::mutex mutex;
  static std::map<const Model*, std::uint32_t> clocks;
  const std::lock_guard<std::mutex> guard(mutex);
  const auto known = clocks.find(&model);
  return known != clocks.end() ? known->second : clocks.emplace(&model, find_clock(bus)).first->second;
}

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

std::string image_of(const Model& model) {
  return std::string(EX9000_IMAGES) + "/" + std::string(model.designation) + ".elf";
}

EmulatedModule::EmulatedModule(const Model& model, const Settings* settings) : model_(model) {
  store(settings);
}

void EmulatedModule::store(const Settings* settings) {
  set_memory(text_of(sim::SimulatedModule::memory_image(
      model_, settings != nullptr ? *settings : Settings::factory(model_))));
}

void EmulatedModule::begin_anew(const Settings* settings) {
  constexpr std::uint8_t kNoise = 0xA5;
  levels_ = {};
  init_asserted_ = false;
  if (!powered()) {
    store(settings);
    power(true);
    return;
  }
  emulator_->halt();
  store(settings);
  emulator_->bus().fill(kRam, kRamSize, kNoise);
  emulator_->reset();
  give_levels();
  while (!emulator_->uart().receive(std::chrono::nanoseconds(0)).empty()) {
  }
  emulator_->run();
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
    come_up_again();
  }
}

bool EmulatedModule::halts_because(const std::string& event) {
  constexpr std::chrono::milliseconds kTurn{50};
  constexpr int kTurns = 200;
  for (int i = 0; i < kTurns; ++i) {
    if (emulator_->qmp().hears(event, kTurn)) {
      return emulator_->qmp().hears("STOP", kTurn * kTurns);
    }
    // Where the image has no timer left but the watchdog's, the emulator forgets the time unless it is asked.
    emulator_->bus().read(kRam);
  }
  return false;
}

void EmulatedModule::come_up_again() {
  emulator_->reset();
  give_levels();
  emulator_->run();
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

std::chrono::microseconds EmulatedModule::time() {
  return std::chrono::microseconds(powered() ? emulator_->bus().read(clock_of(model_, emulator_->bus())) : 0);
}

void EmulatedModule::send(const std::vector<std::uint8_t>& bytes) {
  if (powered()) {
    // It takes what arrives while its driver is on for its echo. On a line that speaks a byte takes its time,
    // and the driver is off soon after the last one has been heard; here it has been heard at once.
    constexpr std::chrono::seconds kPatience{1};
    const auto gives_up = std::chrono::steady_clock::now() + kPatience;
    while (level_of(emulator_->bus(), kDriverEnable) && std::chrono::steady_clock::now() < gives_up) {
    }
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
