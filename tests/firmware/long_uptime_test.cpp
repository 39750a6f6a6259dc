// Tests that the behaviour of a module does not change when the 32-bit counts of the interrupts and the main
// loop wrap, for example after months of operation. This test is built with
// tests/support/long_uptime/firmware/crossing.hpp, which lets the counts start shortly before they wrap.
#include <gtest/gtest.h>

#include "firmware/watchdog/module_watchdog.hpp"
#include "tests/firmware/core_bench.hpp"

namespace ex9000 {
namespace {

using FrameBytes = CoreBench::FrameBytes;

constexpr unsigned kAcrossTheWrap = 3 * kCountsUntilTheWrap;

const FrameBytes kReadInputs{0x01, 0x02, 0x00, 0x00, 0x00, 0x08};
const FrameBytes kNoInput{0x01, 0x02, 0x01, 0x00};
const FrameBytes kHostOk{0x01, 0x03, 0x30, 0x38, 0x00, 0x00};

TEST(LongUptime, InputsLatchesAndCountersFollowEveryEdge) {
  CoreBench bench("EX9052D-M");
  const Inputs& inputs = bench.module().state().inputs;
  for (unsigned pulse = 1; pulse <= kAcrossTheWrap; ++pulse) {
    for (unsigned channel = 0; channel < 8; ++channel) {
      bench.module().on_edge(channel, true, bench.now());
    }
    bench.pass(milliseconds(1));
    ASSERT_EQ(inputs.levels(), 0xFF) << pulse;
    bench.module().on_edge(pulse % 8, false, bench.now());
    bench.pass(milliseconds(1));
    ASSERT_EQ(inputs.levels(), 0xFF ^ (1U << pulse % 8)) << pulse;
    for (unsigned channel = 0; channel < 8; ++channel) {
      if (channel != pulse % 8) {
        bench.module().on_edge(channel, false, bench.now());
      }
    }
    bench.pass(milliseconds(1));
    ASSERT_EQ(inputs.levels(), 0x00) << pulse;
    ASSERT_EQ(inputs.counter(7), pulse);
    ASSERT_EQ(inputs.latched_high(), 0xFF);
    ASSERT_EQ(inputs.latched_low(), 0xFF);
    ASSERT_EQ(bench.ask({0x01, 0x05, 0x01, 0x07, 0xFF, 0x00}).size(), 8U);  // clears the latches
    ASSERT_EQ(inputs.latched_high(), 0x00);
  }
}

// This test makes one edge at a time, so that the main loop reads every value of the edge count around the
// wrap.
TEST(LongUptime, NoSingleEdgeIsMissed) {
  CoreBench bench("EX9052D-M");
  const Inputs& inputs = bench.module().state().inputs;
  for (unsigned edge = 0; edge < kAcrossTheWrap; ++edge) {
    const bool level = edge % 2 == 0;
    bench.module().on_edge(0, level, bench.now());
    bench.pass(milliseconds(1));
    ASSERT_EQ(inputs.levels(), level ? 1U : 0U) << edge;
    ASSERT_EQ(inputs.counter(0), (edge + 1) / 2) << edge;
  }
}

TEST(LongUptime, EveryRequestIsAnsweredOnce) {
  CoreBench bench("EX9052D-M");
  for (unsigned request = 0; request < kAcrossTheWrap; ++request) {
    ASSERT_EQ(bench.ask(kReadInputs), CoreBench::with_crc(kNoInput)) << request;
    ASSERT_TRUE(bench.answer().empty()) << request;
    ASSERT_FALSE(bench.module().frame_waits());
  }
}

TEST(LongUptime, EveryHostOkRestartsTheHostWatchdog) {
  CoreBench bench("EX9052D-M");
  bench.ask({0x01, 0x06, 0x01, 0xE8, 0x00, 0x02});  // 0.2 s
  bench.ask({0x01, 0x05, 0x01, 0x04, 0xFF, 0x00});
  for (unsigned host_ok = 0; host_ok < kAcrossTheWrap; ++host_ok) {
    bench.pass(milliseconds(100));  // the host OK takes another 58 ms
    bench.ask(kHostOk);
    ASSERT_FALSE(bench.module().state().settings.timeout_status) << host_ok;
  }
  bench.pass(milliseconds(100));
  EXPECT_FALSE(bench.module().state().settings.timeout_status);
  bench.pass(milliseconds(101));
  EXPECT_TRUE(bench.module().state().settings.timeout_status);
}

TEST(LongUptime, DiagnosticCountersKeepCounting) {
  CoreBench bench("EX9052D-M");
  const FrameBytes clear{0x01, 0x08, 0x00, 0x0A, 0x00, 0x00};
  ASSERT_EQ(bench.ask(clear), CoreBench::with_crc(clear));
  for (unsigned frame = 0; frame < kAcrossTheWrap; ++frame) {
    bench.hear(CoreBench::with_crc({0x02, 0x07}));
    bench.hear({0xFF});
  }
  const auto low = static_cast<std::uint8_t>(kAcrossTheWrap);
  const auto high = static_cast<std::uint8_t>(kAcrossTheWrap >> 8U);
  EXPECT_EQ(bench.ask({0x01, 0x08, 0x00, 0x0C, 0x00, 0x00}),
            CoreBench::with_crc({0x01, 0x08, 0x00, 0x0C, high, low}));
  // The two requests that read a counter are bus messages too.
  EXPECT_EQ(bench.ask({0x01, 0x08, 0x00, 0x0B, 0x00, 0x00}),
            CoreBench::with_crc({0x01, 0x08, 0x00, 0x0B, high, static_cast<std::uint8_t>(low + 2)}));
}

TEST(LongUptime, TheModuleWatchdogIsFedOnceForEachTick) {
  ModuleWatchdog watchdog;
  watchdog.main_loop_alive();
  for (unsigned tick = 0; tick < kAcrossTheWrap; ++tick) {
    ASSERT_FALSE(watchdog.main_loop_alive()) << tick;
    watchdog.tick_alive();
    ASSERT_TRUE(watchdog.main_loop_alive()) << tick;
  }
}

}  // namespace
}  // namespace ex9000
