// Tests the host watchdog and the module watchdog of a simulated module, also while the memory is busy or
// fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "sim/text/values.hpp"
#include "tests/firmware/core_bench.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// --- wire.md 6: host watchdog ---

TEST(HostWatchdog, HostOksAtIntervalsShorterThanTheTimeoutPreventExpiryAtAnyBaudRate) {
  for (const std::uint32_t baud : kBaudRates) {
    ModuleBench bench("EX9068D-M,baud=" + std::to_string(baud));
    const Bytes host_ok = with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00});
    bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x03});
    bench.send(with_crc({1, 0x05, 0x01, 0x04, 0xFF, 0x00}));
    bench.run(milliseconds(150));
    for (int i = 0; i < 20; ++i) {
      const VirtualTime began = bench.now();
      bench.send(host_ok);
      bench.line().wires().run_until(began + milliseconds(299));
    }
    EXPECT_FALSE(bench.module().module().state().settings.timeout_status) << baud;
  }
}

TEST(HostWatchdog, TheCommandThatClearsTheTimeoutStatusDoesNotClearATimeoutDuringItsStore) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~013101"), "!01");  // the watchdog has expired when `ask` returns
  bench.send("~013101\r");                 // enables the watchdog again
  bench.run(milliseconds(15));
  ASSERT_TRUE(
      bench.runs_until([&bench] { return bench.module().module().state().settings.watchdog_enabled; }));
  bench.run(milliseconds(86));
  bench.forget_heard();
  bench.send("~011\r");
  bench.run(milliseconds(50));
  EXPECT_EQ(bench.heard_text(), "!01\r");
  EXPECT_EQ(bench.ask("~010"), "!0104");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~010"), "!0104");
}

// wire.md 6: module watchdog.
TEST(ModuleWatchdog, IsNotFedWhileAReplyTakesLongerThanItsDeadline) {
  CoreBench bench("EX9042D-M");
  Module& module = bench.module();
  bench.hear(CoreBench::with_crc({0x01, 0x11}));
  module.step(false, bench.now());
  const std::size_t size = module.take_reply(bench.now()).size;
  ASSERT_NE(size, 0U);
  constexpr Duration kCharacter(1042);  // at 9600 baud, 8N1
  const Time began = bench.now();
  const Duration least(static_cast<std::uint32_t>(size) * kCharacter.microseconds());
  const auto fed = [&] {
    bench.pass(ex9000::milliseconds(10));
    module.on_tick();
    return module.feed_watchdog(bench.now());
  };
  while (bench.now().since(began) < least + ex9000::milliseconds(90)) {
    ASSERT_TRUE(fed()) << bench.now().since(began).microseconds() << " us";
  }
  bench.pass(ex9000::milliseconds(20));
  for (int tick = 0; tick < 2000; ++tick) {
    ASSERT_FALSE(fed());
  }
  module.on_reply_sent(bench.now());
  EXPECT_TRUE(fed());
}

TEST(HostWatchdog, RunsEvenIfTheInitSwitchBouncesContinuously) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@010001"), ">");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  ASSERT_EQ(bench.ask("~013104"), "!01");
  bench.module().reset();
  for (int i = 0; i < 200; ++i) {
    bench.module().set_init(i % 2 == 0);
    bench.run(milliseconds(3));
  }
  EXPECT_EQ(bench.module().outputs(), 0);
  EXPECT_EQ(bench.ask("~010"), "!0104");  // the module has started, and treats INIT* as released
}

TEST(HostWatchdog, ExpiresNeverEarlyAndAtMostAMillisecondLateForEveryTimeoutValue) {
  for (unsigned timeout = 1; timeout <= 255; ++timeout) {
    ModuleBench bench("EX9043D");
    ASSERT_EQ(bench.ask("@010001"), ">");
    bench.send("~0131" + hex_byte_text(timeout) + "\r");
    bench.run(milliseconds(50));
    std::vector<OutputChange> changes;
    bench.watch_outputs(changes);
    bench.send("~**\r");
    const VirtualTime restarted = bench.now();
    bench.run(milliseconds(100) * timeout + seconds(1));
    ASSERT_EQ(changes.size(), 1U) << timeout;
    EXPECT_GE(changes[0].at, restarted + milliseconds(100) * timeout) << timeout;
    EXPECT_LE(changes[0].at, restarted + milliseconds(100) * timeout + milliseconds(1)) << timeout;
  }
}

TEST(HostWatchdog, ReportsItsExpiryTime) {
  ModuleBench bench("EX9043D");
  const auto expiry = [&bench] { return bench.module().module().host_watchdog_expiry(); };
  EXPECT_FALSE(expiry().armed());
  ASSERT_EQ(bench.ask("~013110"), "!01");
  ASSERT_TRUE(expiry().armed());
  const Duration left = expiry().remaining(bench.line().clock().now());
  bench.run(microseconds(left.microseconds() - 1));
  EXPECT_FALSE(bench.module().module().state().settings.timeout_status);
  bench.run(milliseconds(1));
  EXPECT_TRUE(bench.module().module().state().settings.timeout_status);
}

TEST(HostWatchdog, StartsBetweenTheEnableCommandAndItsReply) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@010001"), ">");
  std::vector<OutputChange> changes;
  bench.watch_outputs(changes);
  bench.recorder().clear();
  bench.ask("~013101");
  ASSERT_EQ(changes.size(), 1U);
  const VirtualTime request_end = bench.recorder().bytes[7].end;
  const VirtualTime reply_start = bench.recorder().bytes[8].start;
  EXPECT_GE(changes[0].at, request_end + milliseconds(100));
  EXPECT_LE(changes[0].at, reply_start + milliseconds(100));
}

TEST(HostWatchdog, ExpiryDrivesTheSafeValueImmediatelyEvenWhileACommandIsBeingStored) {
  ModuleBench bench("EX9043D-M,baud=115200");
  bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x05});
  bench.ask(Bytes{1, 0x0F, 0x00, 0x00, 0x00, 0x10, 0x02, 0x0F, 0x00});
  bench.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
  bench.send(with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00}));
  const VirtualTime restarted = bench.now() + microseconds(1750);  // the silence that ends the frame
  std::vector<OutputChange> changes;
  bench.watch_outputs(changes);
  // The command below stores a power-on value. The store takes about 10 ms, and the timeout occurs during the
  // store. Without the timeout, the module would drive all outputs after the store.
  bench.run(milliseconds(493));
  bench.forget_heard();
  bench.send(with_crc({1, 0x0F, 0x00, 0xA0, 0x00, 0x10, 0x02, 0xFF, 0xFF}));
  bench.run(milliseconds(250));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].channels, 0);
  EXPECT_GE(changes[0].at, restarted + milliseconds(500));
  EXPECT_LE(changes[0].at, restarted + milliseconds(501));
  EXPECT_FALSE(bench.heard_text().empty());  // the command is stored and gets a reply (wire.md D6)
  EXPECT_EQ(bench.module().module().state().settings.power_on_value, 0xFFFF);
  bench.power_cycle();
  EXPECT_TRUE(bench.module().module().state().settings.timeout_status);
  EXPECT_EQ(bench.module().outputs(), 0);
}

TEST(HostWatchdog, ATimeoutThatCannotBeStoredTakesEffectAndIsStoredLater) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@0100FF"), ">");
  ASSERT_EQ(bench.ask("~013105"), "!01");
  bench.module().memory().fail(true);
  bench.run(milliseconds(600));
  EXPECT_EQ(bench.module().outputs(), 0);
  EXPECT_EQ(bench.ask("~010"), "!0104");
  EXPECT_EQ(bench.ask("~012"), "!01005");
  EXPECT_EQ(bench.ask("@0100FF"), "!");
  bench.module().memory().fail(false);
  bench.run(milliseconds(1500));
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~010"), "!0104");
  EXPECT_EQ(bench.ask("~012"), "!01005");
}

TEST(HostWatchdog, ATimeoutStatusThatIsClearedDuringItsStoreIsClearAfterAPowerCycle) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~013103"), "!01");
  ASSERT_TRUE(bench.runs_until([&bench] { return bench.module().module().state().settings.timeout_status; }));
  EXPECT_EQ(bench.ask("~011"), "!01");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~010"), "!0100");
}

TEST(HostWatchdog, TheLedFlashesAtTwoHertzUntilTheTimeoutStatusIsCleared) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("~013101"), "!01");
  bench.run(seconds(1));
  std::vector<VirtualTime> changes;
  bench.module().led().on_change([&](bool /*lit*/) { changes.push_back(bench.now()); });
  bench.run(seconds(10));
  ASSERT_EQ(changes.size(), 40U);
  for (std::size_t i = 1; i < changes.size(); ++i) {
    EXPECT_NEAR(static_cast<double>((changes[i] - changes[i - 1]).count()), 250e6, 2e3);
  }
  ASSERT_EQ(bench.ask("~011"), "!01");
  changes.clear();
  bench.run(seconds(2));
  EXPECT_TRUE(changes.empty());
  EXPECT_TRUE(bench.module().led_lit());
}

// --- wire.md 6: module watchdog ---

TEST(ModuleWatchdog, AHungMainLoopCausesAReportedResetToThePowerOnValue) {
  ModuleBench bench("EX9068D-M,protocol=ascii");
  ASSERT_EQ(bench.ask("@0155"), ">");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  ASSERT_EQ(bench.ask("@01FF"), ">");
  ASSERT_EQ(bench.ask("$015"), "!011");
  ASSERT_EQ(bench.ask("$015"), "!010");
  bench.module().hang();
  EXPECT_EQ(bench.ask("$015"), "");
  bench.run(milliseconds(1600 - 250) + milliseconds(100));
  EXPECT_EQ(bench.module().watchdog_resets(), 1U);
  EXPECT_EQ(bench.ask("$015"), "!011");
  EXPECT_EQ(bench.module().outputs(), 0x55);
}

TEST(ModuleWatchdog, AStoppedTickCausesAResetWithin1600ms) {
  ModuleBench bench("EX9068D-M,protocol=ascii");
  bench.module().stop_tick();
  bench.run(milliseconds(1600));
  EXPECT_EQ(bench.module().watchdog_resets(), 1U);
}

TEST(ModuleWatchdog, AHealthyModuleIsNotResetWithinThreeHours) {
  ModuleBench bench("EX9068D-M");
  bench.run(std::chrono::hours(3));
  EXPECT_EQ(bench.module().watchdog_resets(), 0U);
}

}  // namespace
}  // namespace ex9000::sim
