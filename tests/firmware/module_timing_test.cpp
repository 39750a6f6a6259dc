// Tests a module when the clock wraps, and after long pauses.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Driver, TheEchoOfAReplyIsNeverProcessedAsARequest) {
  // The name looks like a command for this module. On a two-wire line, the module receives the reply that it
  // sends, and the reply contains the name.
  ModuleBench bench("EX9042D,name=$01M");
  EXPECT_EQ(bench.ask("$01M"), "!01$01M");
  bench.run(seconds(1));
  EXPECT_EQ(bench.recorder().sent_by(1).size(), 8U);
}

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
