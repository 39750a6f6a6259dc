// Tests the timing of a module: of its reset, of INIT*, of its replies and of its driver. Also tests the
// timing when the clock wraps, and after long pauses.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// --- wire.md section 2: reset and INIT* ---

TEST(Reset, OutputsGoFromDeEnergisedToThePowerOnValueWithoutAGlitch) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@01A55A"), ">");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  ASSERT_EQ(bench.ask("@01FFFF"), ">");
  std::vector<OutputChange> changes;
  bench.watch_outputs(changes);
  bench.module().reset();
  bench.run(milliseconds(100));
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[0].channels, 0);
  EXPECT_EQ(changes[1].channels, 0xA55A);
  EXPECT_LT(changes[1].at - changes[0].at, milliseconds(100));
}

TEST(Reset, AfterTheInitSwitchStopsBouncingItsStableLevelCounts) {
  ModuleBench bench("EX9042D");
  for (int i = 0; i < 20; ++i) {
    bench.module().set_init(i % 2 == 0);
    bench.run(milliseconds(5));
  }
  bench.module().set_init(false);
  EXPECT_EQ(bench.ask("%0101400700"), "?01");
  bench.module().power(false);
  bench.module().power(true);
  for (int i = 0; i < 10; ++i) {
    bench.module().set_init(i % 2 == 0);
    bench.run(milliseconds(3));
  }
  bench.module().set_init(true);
  bench.run(milliseconds(50));
  EXPECT_EQ(bench.ask("$002"), "!01400600");
}

// --- wire.md sections 3 and 7: start of a reply; section 9: driver; firmware/extensions.md: line formats ---

/// A baud rate, a line format, and the duration of a character.
struct LineMode {
  std::uint32_t baud;
  const char* format;
  VirtualTime character;

  /// Returns the specification of a module with this line mode.
  [[nodiscard]] std::string of(const std::string& model) const {
    return model + ",baud=" + std::to_string(baud) + ",format=" + format;
  }
  friend std::ostream& operator<<(std::ostream& out, const LineMode& mode) {
    return out << mode.baud << " baud " << mode.format;
  }
};

std::vector<LineMode> all_line_modes() {
  std::vector<LineMode> modes;
  for (const std::uint32_t baud : kBaudRates) {
    modes.push_back({baud, "8N1", VirtualTime(10'000'000'000 / baud)});
    for (const char* const format : {"8N2", "8E1", "8O1"}) {
      modes.push_back({baud, format, VirtualTime(11'000'000'000 / baud)});
    }
  }
  return modes;
}

TEST(Timing, ACharacterHasTenBitsIn8N1AndElevenInTheOtherFormats) {
  for (const LineMode& mode : all_line_modes()) {
    ModuleBench bench(mode.of("EX9055D"));
    ASSERT_EQ(bench.ask("$01M"), "!019055") << mode;
    const auto& bytes = bench.recorder().bytes;
    ASSERT_EQ(bytes.size(), 13U) << mode;
    for (std::size_t i = 6; i < bytes.size(); ++i) {  // the bytes of the reply have no gaps
      EXPECT_NEAR(static_cast<double>((bytes[i].start - bytes[i - 1].start).count()),
                  static_cast<double>(mode.character.count()), 2.0)
          << mode;
    }
  }
}

TEST(Timing, AnAsciiReplyStartsAfterOneCharacterAndWithin20msOr200msIfASettingIsStored) {
  for (const LineMode& mode : all_line_modes()) {
    ModuleBench bench(mode.of("EX9055D"));
    for (const auto& [command, most] :
         std::vector<std::pair<std::string, VirtualTime>>{{"$012", milliseconds(20)},
                                                          {"@01FF", milliseconds(20)},
                                                          {"#010", milliseconds(20)},
                                                          {"$01Z", milliseconds(20)},
                                                          {"~01ONEW", milliseconds(200)},
                                                          {"~0131FF", milliseconds(200)}}) {
      bench.recorder().clear();
      ASSERT_NE(bench.ask(command), "") << command;
      const std::size_t request = command.size() + 1;
      const VirtualTime gap = bench.recorder().bytes[request].start - bench.recorder().bytes[request - 1].end;
      EXPECT_GE(gap, mode.character) << command << " at " << mode;
      EXPECT_LE(gap, most) << command << " at " << mode;
    }
  }
}

TEST(Timing, AModbusReplyStartsAfterT35AndWithin20msOr200msIfASettingIsStored) {
  for (const LineMode& mode : all_line_modes()) {
    ModuleBench bench(mode.of("EX9042D-M"));
    const std::uint32_t baud = mode.baud;
    const VirtualTime silence = baud > 19200 ? VirtualTime(1'750'000) : VirtualTime(38'500'000'000 / baud);
    for (const auto& [frame, most] :
         std::vector<std::pair<Bytes, VirtualTime>>{{{1, 0x01, 0, 0, 0, 13}, milliseconds(20)},
                                                    {{1, 0x05, 0, 0, 0xFF, 0}, milliseconds(20)},
                                                    {{1, 0x41}, milliseconds(20)},
                                                    {{1, 0x06, 0x01, 0xE8, 0, 50}, milliseconds(200)}}) {
      bench.recorder().clear();
      ASSERT_FALSE(bench.ask(frame).empty());
      const std::size_t request = frame.size() + 2;
      const VirtualTime gap = bench.recorder().bytes[request].start - bench.recorder().bytes[request - 1].end;
      EXPECT_GE(gap, silence) << mode;
      EXPECT_LE(gap, silence + most) << mode;
    }
  }
}

// firmware/extensions.md: the response delay counts from the last stop bit of the request. The limits of 20
// ms and 200 ms count from the end of the response delay if the delay ends after the turn-around.
TEST(Timing, AReplyStartsAtTheEndOfTheResponseDelayAndAStoreDoesNotAddToIt) {
  for (const LineMode& mode : all_line_modes()) {
    ModuleBench bench(mode.of("EX9055D"));
    const std::uint32_t baud = mode.baud;
    ASSERT_EQ(bench.ask("~01RD1E"), "!01");
    for (const std::string command : {"$012", "$01Z", "~01ONEW", "~01OOLD"}) {
      bench.recorder().clear();
      ASSERT_NE(bench.ask(command), "") << command;
      const std::size_t request = command.size() + 1;
      const VirtualTime gap = bench.recorder().bytes[request].start - bench.recorder().bytes[request - 1].end;
      EXPECT_GE(gap, milliseconds(30)) << command << " at " << mode;
      // At 1200 baud the turn-around and the store together take a little longer than the delay.
      EXPECT_LE(gap, milliseconds(baud == 1200 ? 35 : 31)) << command << " at " << mode;
    }
  }
}

TEST(Timing, TheEffectOfARequestIsNotDelayed) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~01RD1E"), "!01");
  std::vector<OutputChange> changes;
  bench.watch_outputs(changes);
  bench.send("@010001\r");
  const VirtualTime sent = bench.now();
  bench.run(milliseconds(50));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_LE(changes[0].at - sent, milliseconds(1));
}

TEST(Driver, IsOnBeforeTheFirstStartBitAndOffWithinACharacterAfterTheLastStopBit) {
  for (const LineMode& mode : all_line_modes()) {
    ModuleBench bench(mode.of("EX9042D"));
    bench.ask("$01M");
    const auto& drivers = bench.recorder().drivers;
    const auto& bytes = bench.recorder().bytes;
    ASSERT_EQ(drivers.size(), 4U);  // on and off: first the master's driver, then the module's driver
    ASSERT_EQ(drivers[2].station, 1U);
    EXPECT_LT(drivers[2].at, bytes[5].start);
    EXPECT_GE(drivers[3].at, bytes.back().end);
    EXPECT_LE(drivers[3].at, bytes.back().end + mode.character);
  }
}

TEST(Driver, TheEchoOfAReplyIsNeverProcessedAsARequest) {
  // The name looks like a command for this module. On a two-wire line, the module receives the reply that it
  // sends, and the reply contains the name.
  ModuleBench bench("EX9042D,name=$01M");
  EXPECT_EQ(bench.ask("$01M"), "!01$01M");
  bench.run(seconds(1));
  EXPECT_EQ(bench.recorder().sent_by(1).size(), 8U);
}

// --- clock ---

TEST(Time, TheHostWatchdogExpiresOnTimeAcrossTheClockWrap) {
  constexpr microseconds kWrap{std::int64_t{1} << 32};
  ModuleBench bench("EX9043D-M");
  ASSERT_EQ(bench.ask(Bytes{1, 0x0F, 0x00, 0x00, 0x00, 0x10, 0x02, 0x0F, 0x00}).at(1), 0x0F);
  ASSERT_EQ(bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x14}).at(1), 0x06);
  bench.line().wires().run_until(kWrap - milliseconds(1000));
  ASSERT_EQ(bench.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00}).at(1), 0x05);
  const Bytes host_ok = with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00});
  // The clock wraps while the master sends the frame.
  bench.line().wires().run_until(kWrap - milliseconds(4));
  bench.send(host_ok);
  const VirtualTime restarted = bench.now() + microseconds(4010);  // T3.5 after the frame
  ASSERT_GT(restarted, kWrap);
  std::vector<OutputChange> changes;
  bench.watch_outputs(changes);
  bench.run(seconds(3));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_GE(changes[0].at, restarted + seconds(2));
  EXPECT_LE(changes[0].at, restarted + seconds(2) + milliseconds(1));
  EXPECT_EQ(bench.module().watchdog_resets(), 0U);
}

TEST(Time, AMasterThatPollsOncePerClockWrapIsAnsweredEveryTime) {
  constexpr microseconds kWrap{std::int64_t{1} << 32};
  ModuleBench bench("EX9042D-M");
  for (int i = 0; i < 5; ++i) {
    const VirtualTime began = bench.now();
    ASSERT_EQ(bench.ask(Bytes{1, 0x01, 0, 0, 0, 13}), (Bytes{1, 0x01, 2, 0, 0}));
    bench.line().wires().run_until(began + kWrap);
  }
}

// On a 32-bit microsecond clock, a moment that is 36 to 71 minutes in the past looks like one in the future.
constexpr std::array kPauses{std::chrono::minutes(36), std::chrono::minutes(50), std::chrono::minutes(71)};

TEST(Time, ARequestIsAnsweredAfterAPauseOf36To71Minutes) {
  ModuleBench modbus("EX9042D-M");
  ModuleBench ascii("EX9042D");
  for (const auto pause : kPauses) {
    EXPECT_EQ(modbus.ask(Bytes{1, 0x01, 0, 0, 0, 13}), (Bytes{1, 0x01, 2, 0, 0}));
    EXPECT_EQ(ascii.ask("$01M"), "!019042D");
    modbus.run(pause);
    ascii.run(pause);
    EXPECT_EQ(modbus.ask(Bytes{1, 0x01, 0, 0, 0, 13}), (Bytes{1, 0x01, 2, 0, 0})) << pause.count();
    EXPECT_EQ(ascii.ask("$01M"), "!019042D") << pause.count();
  }
}

TEST(Time, InitSwitchHostWatchdogAndStoresAreOnTimeAfterAPauseOf36To71Minutes) {
  ModuleBench bench("EX9042D");
  unsigned number = 0;
  for (const auto pause : kPauses) {
    const std::string name = "PUMP" + std::to_string(++number);
    bench.run(pause);
    EXPECT_EQ(bench.ask("~01O" + name), "!01") << pause.count();
    EXPECT_EQ(bench.ask("$01M"), "!01" + name);
    bench.run(pause);
    bench.module().set_init(true);
    bench.run(milliseconds(20));
    EXPECT_EQ(bench.ask("%0101400800"), "!01") << pause.count();
    bench.run(pause);
    bench.module().set_init(false);
    bench.run(milliseconds(20));
    EXPECT_EQ(bench.ask("%0101400700"), "?01") << pause.count();
    bench.run(pause);
    // The timeout is 0.4 s. Each `ask` takes more than 0.25 s.
    EXPECT_EQ(bench.ask("~013104"), "!01") << pause.count();
    EXPECT_EQ(bench.ask("~010"), "!0180");
    EXPECT_EQ(bench.ask("~010"), "!0184");
    EXPECT_EQ(bench.ask("~011"), "!01");
  }
}

}  // namespace
}  // namespace ex9000::sim
