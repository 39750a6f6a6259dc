// The fixture of the tests of images for the Pico in the emulator.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>

#include EX9000_BOARD_HEADER
#include "firmware/model/baud.hpp"
#include "tests/rp2040/pico_bench.hpp"

namespace ex9000::pico {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// The longest period of the module's watchdog: wire.md section 6.
constexpr milliseconds kWatchdogPeriod{1600};

// To spoil an image: numbers of exceptions, and instructions in place of the first one of a handler.
constexpr unsigned kReset = 1;
constexpr unsigned kSystemTick = 15;
constexpr unsigned kFirstInterrupt = 16;
constexpr unsigned kUart0 = kFirstInterrupt + 20;
constexpr std::uint16_t kBranchToItself = 0xE7FE;
constexpr std::uint16_t kUndefined = 0xDE00;
constexpr std::uint16_t kReturn = 0x4770;  // BX LR

inline play::Bytes text(const std::string& characters) { return {characters.begin(), characters.end()}; }

/// Sends `request`, and returns the time from its end to the start bit of the reply. `bit` is the duration of
/// a bit. The first byte of the reply must arrive within 20 ms.
inline nanoseconds turn_around(PicoBench& bench, const play::Bytes& request, nanoseconds bit) {
  bench.send(request);
  const nanoseconds end = bench.now();
  bench.run_for(milliseconds(20));
  const std::string arrivals = bench.execute("arrivals");
  const nanoseconds middle_of_stop_bit(std::stoll(arrivals.substr(arrivals.find('@') + 1)));
  return middle_of_stop_bit - bit * 19 / 2 - end;
}

class PicoImage : public testing::Test {
 protected:
  static constexpr milliseconds kPatience{100};

  explicit PicoImage(Memory memory = Memory::Flash) : bench_(memory) {}

  static constexpr std::uint16_t kPowerOnValue = 0x5A5A;
  static constexpr std::uint16_t kSafeValue = 0xA5A4;

  void begin(const char* designation = "EX9043D-M", std::uint32_t baud = 9600) {
    const Model& model = *find_model(designation);
    Settings settings = Settings::factory(model);
    settings.protocol = Protocol::Ascii;
    while (baud_rate(settings.baud_code) != baud) {
      settings.baud_code = settings.baud_code == kLastBaudCode
                               ? kFirstBaudCode
                               : static_cast<std::uint8_t>(settings.baud_code + 1U);
    }
    if (model.outputs != 0) {
      settings.power_on_value = kPowerOnValue & model.output_mask();
      settings.safe_value = kSafeValue & model.output_mask();
    }
    bench_.begin_anew(model, &settings);
    bench_.set_baud(baud);
    bench_.power(true);
    bench_.come_up();
  }

  std::string ask(const std::string& request) {
    bench_.send(text(request + "\r"));
    const play::Bytes reply = bench_.receive(64, kPatience);
    return {reply.begin(), reply.end()};
  }

  /// Returns the number that a command of the emulator prints.
  std::uint32_t number(const std::string& command) {
    return static_cast<std::uint32_t>(std::stoul(bench_.execute(command)));
  }

  PicoBench bench_;
};

}  // namespace ex9000::pico
