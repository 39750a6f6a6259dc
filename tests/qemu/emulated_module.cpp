#include "tests/qemu/emulated_module.hpp"

#include <stdexcept>
#include <thread>

#include "tests/qemu/signals.hpp"

namespace ex9000::rig {

void EmulatedModule::power(bool on) {
  if (on == powered()) {
    return;
  }
  supply(on);
  if (on) {
    emulator().run();
  }
}

bool EmulatedModule::halts_because(const std::string& event) {
  constexpr std::chrono::milliseconds kTurn{50};
  constexpr int kTurns = 200;
  constexpr std::uint32_t kAnywhere = 0x2000'0000;
  for (int i = 0; i < kTurns; ++i) {
    if (emulator().qmp().hears(event, kTurn)) {
      return emulator().qmp().hears("STOP", kTurn * kTurns);
    }
    // Where the image has no timer left but the watchdog's, the emulator forgets the time unless it is asked.
    emulator().bus().read(kAnywhere);
  }
  return false;
}

void EmulatedModule::come_up_again() {
  pull_reset();
  emulator().run();
}

void EmulatedModule::set_input(unsigned channel, bool level) {
  constexpr std::chrono::seconds kPatience{20};
  constexpr std::uint32_t kInterruptState = 0xE000'ED04;
  constexpr std::uint32_t kAnyActiveOrPending = 0x0040'01FF;
  set_level(channel, level);
  const auto gives_up = std::chrono::steady_clock::now() + kPatience;
  while ((emulator().bus().read(kInterruptState) & kAnyActiveOrPending) != 0) {
    if (std::chrono::steady_clock::now() > gives_up) {
      throw std::runtime_error("the image does not take an edge");
    }
  }
}

void EmulatedModule::send(const std::vector<std::uint8_t>& bytes) {
  if (powered()) {
    // It takes what arrives while its driver is on for its echo. On a line that speaks a byte takes its time,
    // and the driver is off soon after the last one has been heard; here it has been heard at once.
    constexpr std::chrono::seconds kPatience{1};
    const auto gives_up = std::chrono::steady_clock::now() + kPatience;
    while (level_of(emulator().bus(), board::kDriverEnable) && std::chrono::steady_clock::now() < gives_up) {
    }
    emulator().uart().send(bytes.data(), bytes.size());
  }
}

std::vector<std::uint8_t> EmulatedModule::hear(std::chrono::nanoseconds patience) {
  if (powered()) {
    return emulator().uart().receive(patience);
  }
  std::this_thread::sleep_for(patience);
  return {};
}

}  // namespace ex9000::rig
