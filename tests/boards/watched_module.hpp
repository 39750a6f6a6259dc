// For tests of the watchdogs: a module on its board, with a master; the settings and the activities of the
// module; and the fixture of the tests.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "sim/virtual_line/wires/module.hpp"
#include "tests/boards/images_under_test.hpp"
#include "tests/mcu_model/board_bench.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/support/either_protocol.hpp"

namespace ex9000::registers {

inline constexpr std::chrono::milliseconds kComesUpWithin{100};
inline constexpr std::chrono::milliseconds kTick{10};

inline constexpr std::uint16_t kPowerOnValue = 0x5A5A;
inline constexpr std::uint16_t kSafeValue = 0xA5A4;
inline constexpr std::uint16_t kDriven = 0xC35A;
inline constexpr std::uint8_t kTimeout = 0x64;

/// Returns the low byte of `value` as two hex digits.
inline std::string hex(unsigned value) { return reference::hex(value, 2); }

/// Returns settings with an enabled host watchdog. The model must have 16 outputs or none. If it has outputs,
/// the power-on value and the safe value differ from each other and from kDriven.
inline Settings set_up(const Model& model, Protocol protocol) {
  Settings settings = Settings::factory(model);
  settings.protocol = protocol;
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = kTimeout;
  if (model.outputs != 0) {
    settings.power_on_value = kPowerOnValue;
    settings.safe_value = kSafeValue;
  }
  return settings;
}

/// A module on its board, with a master that uses the module's protocol.
class WatchedModule : public EitherProtocol {
 public:
  struct Change {
    Instant at;
    std::uint16_t outputs;
  };

  WatchedModule(const ImageName& name, const Settings& settings)
      : EitherProtocol(settings.protocol, [this](const Bytes& frame) { return bench.exchange(frame); }),
        model(*find_model(name.model)),
        bench(image_of(name.board, name.model)) {
    bench.memory = sim::SimulatedModule::memory_image(model, settings);
    for (unsigned channel = 0; channel < bench.image.outputs; ++channel) {
      bench.net(bench.image.output_pins.at(channel)).on_change([this] {
        changes.push_back({bench.timeline.now(), bench.outputs()});
      });
    }
    power_up();
  }

  void power_up() {
    bench.power_on();
    bench.run_for(kComesUpWithin);
    ASSERT_TRUE(uart().enabled());
  }
  void power_cycle() {
    bench.power_off();
    bench.run_for(std::chrono::milliseconds(20));
    power_up();
  }

  UartPort& uart() { return bench.image.uart == 0 ? bench.mcu->uart0 : bench.mcu->uart1; }

  Bytes text(const std::string& reply) { return framed(reply, {}); }

  /// Drives `value` on all outputs of a model with 16 outputs. Returns whether the module accepted the
  /// command.
  bool drive(std::uint16_t value) {
    const Bytes reply = bench.exchange(drive_frame(value));
    return ascii() ? reply == text(">") : reply.size() == 8 && reply[1] == 0x0F;
  }
  [[nodiscard]] Bytes drive_frame(std::uint16_t value) const {
    return framed("@01" + hex(value / 256U) + hex(value),
                  {1, 0x0F, 0, 0, 0, 16, 2, static_cast<std::uint8_t>(value & 0xFFU),
                   static_cast<std::uint8_t>(value >> 8U)});
  }
  bool stores_a_timeout(std::uint8_t timeout) {
    const Bytes reply = ask("~0131" + hex(timeout), {1, 0x06, 0x01, 0xE8, 0, timeout});
    return ascii() ? reply == text("!01") : reply.size() == 8 && reply[1] == 0x06;
  }
  /// Sends a host OK and returns the time at which the module has received it.
  Instant host_ok() { return receives(framed("~**", {1, 0x03, 0x30, 0x38, 0, 0})); }
  /// Sends a frame, waits until the last bit is sent, and returns the time at which the module has received
  /// the frame. For Modbus, this time is the end of the silence after the frame. For ASCII, it is the middle
  /// of the stop bit of the last character, when the UART reports the character.
  Instant receives(const Bytes& frame) {
    bench.line.send(frame);
    while (bench.line.sending()) {
      bench.run_for(std::chrono::microseconds(10));
    }
    return bench.line.sent() + over_behind_its_last_bit();
  }
  /// Waits until it is time to send a host OK. If the test sends the host OK immediately after this call, the
  /// module has received the host OK at the time `phase` after a tick.
  void wait_until_a_host_ok_is_over_behind_a_tick(Instant phase) {
    constexpr unsigned kAscii = 4;
    constexpr unsigned kModbus = 8;
    const Instant takes =
        (ascii() ? kAscii : kModbus) * bench.line.character_time() + over_behind_its_last_bit();
    const Instant tick = bench.mcu->core.ticked();
    Instant wait = (tick + phase - bench.timeline.now() - takes) % kTick;
    wait += wait < Instant(0) ? kTick : Instant(0);
    bench.run_for(wait);
  }

  const Model& model;
  std::vector<Change> changes;  ///< of the outputs; declared before `bench` because it must outlive `bench`
  BoardBench bench;

 private:
  Instant over_behind_its_last_bit() {
    const Instant bit = bench.line.bit_time();
    return ascii() ? -bit / 2 : 77 * bit / 2;
  }
};

/// Runs until `condition` is true, and checks it after every `step`. Returns false if the condition is not
/// true within a second of simulated time.
template <class Condition>
bool runs_until(BoardBench& bench, Condition condition, Instant step) {
  const Instant gives_up = bench.timeline.now() + std::chrono::seconds(1);
  while (!condition() && bench.timeline.now() < gives_up) {
    bench.run_for(step);
  }
  return condition();
}

enum class Doing : std::uint8_t { Nothing, Receiving, Answering, OnTheEepromsBus, Programming };
inline constexpr Doing kEverything[] = {Doing::Nothing, Doing::Receiving, Doing::Answering,
                                        Doing::OnTheEepromsBus, Doing::Programming};
inline const char* name_of(Doing doing) {
  switch (doing) {
    case Doing::Nothing:
      return "idle";
    case Doing::Receiving:
      return "receiving";
    case Doing::Answering:
      return "answering";
    case Doing::OnTheEepromsBus:
      return "writing to the EEPROM";
    case Doing::Programming:
      return "waiting for the EEPROM";
  }
  return "";
}

/// Makes the module start this activity, and returns during the activity. To make the module write to the
/// EEPROM, sends a request that sets the name (in ASCII) or the timeout of the host watchdog (in Modbus).
inline void make_it(WatchedModule& module, Doing doing) {
  BoardBench& bench = module.bench;
  const WatchedModule::Bytes harmless = module.framed("$01M", {1, 0x11});
  const WatchedModule::Bytes storing = module.framed("~01OPUMP", {1, 0x06, 0x01, 0xE8, 0, 0x65});
  unsigned events = 0;
  bench.line.drives.clear();
  switch (doing) {
    case Doing::Nothing:
      break;
    case Doing::Receiving:
      bench.line.send({harmless.begin(), harmless.begin() + 2});
      bench.run_for(3 * bench.line.character_time() / 2);
      break;
    case Doing::Answering:
      bench.line.send(harmless);
      ASSERT_TRUE(runs_until(
          bench, [&] { return !bench.line.drives.empty(); }, std::chrono::microseconds(100)));
      bench.run_for(3 * bench.line.character_time() / 2);
      ASSERT_TRUE(bench.line.driven());
      break;
    case Doing::OnTheEepromsBus:
      bench.eeprom.on_event([&events] { ++events; });
      bench.line.send(storing);
      ASSERT_TRUE(runs_until(
          bench, [&] { return events >= 12; }, std::chrono::microseconds(10)));
      bench.eeprom.on_event(nullptr);
      break;
    case Doing::Programming:
      bench.line.send(storing);
      ASSERT_TRUE(runs_until(
          bench, [&] { return bench.eeprom.programming(); }, std::chrono::microseconds(100)));
      break;
  }
}

/// The fixture of tests whose parameter is an image and the protocol of its module.
class WatchedImage : public testing::TestWithParam<std::tuple<ImageName, Protocol>> {
 protected:
  [[nodiscard]] ImageName image() const { return std::get<0>(GetParam()); }
  [[nodiscard]] Protocol protocol() const { return std::get<1>(GetParam()); }
};

inline const auto kBothProtocols = testing::Values(Protocol::Ascii, Protocol::ModbusRtu);

/// Returns the name of a parameter, for INSTANTIATE_TEST_SUITE_P.
inline std::string name_of_watched_image(const testing::TestParamInfo<WatchedImage::ParamType>& info) {
  return name_of(testing::TestParamInfo<ImageName>(std::get<0>(info.param), info.index)) +
         (std::get<1>(info.param) == Protocol::Ascii ? "_ASCII" : "_Modbus");
}

}  // namespace ex9000::registers
