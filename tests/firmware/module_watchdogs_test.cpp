// Tests the host watchdog and the module watchdog of a simulated module.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/text/values.hpp"
#include "tests/firmware/core_bench.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

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

// The driver of a byte FF of an arbitration stays on: extensions.md, scan.
TEST(ModuleWatchdog, IsNotFedIfAnArbitrationJamsTheLine) {
  CoreBench bench("EX9042D-M");
  Module& module = bench.module();
  bench.hear(CoreBench::with_crc({0x01, 0x10, 0x01, 0x0E, 0x00, 0x02, 0x04, 0x0D, 0x00, 0x00, 0x01}));
  ASSERT_FALSE(bench.answer().empty());
  module.on_reply_sent(bench.now());
  bench.hear(CoreBench::with_crc({0xFD, 0x46, 0x01}));
  ASSERT_EQ(module.take_burst().size, 1U);
  const auto fed = [&] {
    bench.pass(ex9000::milliseconds(60));
    module.on_tick();
    return module.feed_watchdog(bench.now());
  };
  EXPECT_TRUE(fed());
  EXPECT_FALSE(fed());
  module.on_reply_sent(bench.now());
  EXPECT_TRUE(fed());
}

// wire.md 2: a crash loop.
class CrashLoop : public testing::Test {
 protected:
  CrashLoop() {
    EXPECT_EQ(bench_.ask("@018000"), ">");
    EXPECT_EQ(bench_.ask("~015S"), "!01");
    EXPECT_EQ(bench_.ask("@010001"), ">");
    EXPECT_EQ(bench_.ask("~015P"), "!01");
  }
  /// The outputs after a reset by the watchdog.
  std::uint16_t crash() {
    const std::uint64_t resets = bench_.module().watchdog_resets();
    bench_.module().hang();
    bench_.run(milliseconds(1700));
    EXPECT_EQ(bench_.module().watchdog_resets(), resets + 1);
    return bench_.module().outputs();
  }

  static constexpr std::uint16_t kPowerOn = 0x0001;
  static constexpr std::uint16_t kSafe = 0x8000;
  ModuleBench bench_{"EX9043D@01,protocol=ascii"};
};

TEST_F(CrashLoop, TheThirdAndEveryLaterResetInARowLeadsToTheSafeValueButBlocksNothing) {
  EXPECT_EQ(crash(), kPowerOn);
  EXPECT_EQ(crash(), kPowerOn);
  EXPECT_EQ(crash(), kSafe);
  EXPECT_EQ(bench_.ask("~010"), "!0100") << "no timeout status";
  EXPECT_EQ(bench_.ask("@010004"), ">");
  EXPECT_EQ(bench_.module().outputs(), 0x0004);
  EXPECT_EQ(crash(), kSafe);
}

TEST_F(CrashLoop, ALifeOfAMinuteBetweenTwoEndsTheRow) {
  crash();
  crash();
  bench_.run(seconds(58));
  EXPECT_EQ(crash(), kSafe);
  bench_.run(seconds(61));
  EXPECT_EQ(crash(), kPowerOn);
  EXPECT_EQ(crash(), kPowerOn);
  EXPECT_EQ(crash(), kSafe);
}

TEST_F(CrashLoop, AnyOtherResetBetweenTwoEndsTheRow) {
  for (const bool power : {false, true}) {
    crash();
    crash();
    if (power) {
      bench_.module().power(false);
      bench_.module().power(true);
    } else {
      bench_.module().reset();
    }
    bench_.run(milliseconds(100));
    EXPECT_EQ(crash(), kPowerOn);
    EXPECT_EQ(crash(), kPowerOn);
    EXPECT_EQ(crash(), kSafe);
    bench_.run(seconds(61));
  }
}

TEST(CrashCount, CountsFaultsTooAndIgnoresAWordThatTheBoardHasLost) {
  CrashCount count;
  count.begin(ResetReason::Fault, 0xFFFF'FFFF);
  EXPECT_FALSE(count.looping());
  for (const bool looping : {false, true, true}) {
    count.begin(ResetReason::Fault, count.to_keep());
    EXPECT_EQ(count.looping(), looping);
  }
  count.begin(ResetReason::ResetPin, count.to_keep());
  EXPECT_FALSE(count.looping());
}

// extensions.md, scan: a module that processes a request takes no part.
TEST(Scan, AModuleTakesNoPartWhileARequestWaitsOrItsReplyIsOnTheLine) {
  CoreBench bench("EX9042D-M");
  Module& module = bench.module();
  bench.ask({0x01, 0x10, 0x01, 0x0E, 0x00, 0x02, 0x04, 0x0D, 0x00, 0x00, 0x01});
  bench.hear(CoreBench::with_crc({0x01, 0x11}));
  bench.hear(CoreBench::with_crc({0xFD, 0x46, 0x01}));
  EXPECT_EQ(module.take_burst().size, 0U) << "a request waits";
  module.step(false, bench.now());
  ASSERT_NE(module.take_reply(bench.now()).size, 0U);
  bench.hear(CoreBench::with_crc({0xFD, 0x46, 0x01}));
  EXPECT_EQ(module.take_burst().size, 0U) << "the reply is on the line";
  module.on_reply_sent(bench.now());
  bench.hear(CoreBench::with_crc({0xFD, 0x46, 0x01}));
  EXPECT_EQ(module.take_burst().size, 1U);
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

/// wire.md D6: the safe value stays even if a store ends after the expiry and its command drives outputs.
TEST(HostWatchdog, AnExpiryDuringAStoreKeepsTheSafeValue) {
  unsigned stored = 0;
  for (int early = 0; early < 40; ++early) {
    ModuleBench bench("EX9042D-M,baud=115200");
    bench.ask(ModuleBench::Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x05});
    bench.ask(ModuleBench::Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
    bench.run(milliseconds(250 - early));
    bench.ask(ModuleBench::Bytes{1, 0x05, 0x00, 0xA0, 0xFF, 0x00});
    EXPECT_EQ(bench.module().outputs(), 0) << early;
    stored += bench.module().module().state().settings.power_on_value;
  }
  EXPECT_GT(stored, 30U);
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

TEST(ModuleWatchdog, AHealthyModuleIsNotResetWithinThreeHours) {
  ModuleBench bench("EX9068D-M");
  bench.run(std::chrono::hours(3));
  EXPECT_EQ(bench.module().watchdog_resets(), 0U);
}

}  // namespace
}  // namespace ex9000::sim
