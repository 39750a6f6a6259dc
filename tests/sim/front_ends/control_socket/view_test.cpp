// Tests the replies of the control socket about outputs, LED, status, timers and filters.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

TEST(ControlOutputs, EveryOutputOfEveryModelHasItsOwnBit) {
  for (const Model& model : kModels) {
    if (model.outputs == 0) {
      continue;
    }
    const std::string spec(model.designation);
    ControlBench bench(spec + (model.speaks_modbus() ? ",protocol=ascii" : ""));
    for (unsigned channel = 0; channel < model.outputs; ++channel) {
      const std::string group = channel < 8 ? "1" : "B";
      ASSERT_EQ(bench.ask("#01" + group + std::to_string(channel % 8) + "01"), ">") << spec << channel;
      EXPECT_EQ(bench.number("1 outputs"), (2U << channel) - 1) << spec << channel;
    }
  }
}

TEST(ControlLed, FlashesAfterATimeoutAndIsOffWithoutPower) {
  ControlBench bench("EX9042D");
  EXPECT_EQ(bench.tell("1 led"), "ok on");
  ASSERT_EQ(bench.ask("~013101"), "!01");
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.tell("1 led"), "ok flashing");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 led"), "ok off");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.tell("1 led"), "ok flashing");
  ASSERT_EQ(bench.ask("~011"), "!01");
  EXPECT_EQ(bench.tell("1 led"), "ok on");
}

TEST(ControlLed, FlashesWhileTheSettingsCannotBeRead) {
  ControlBench bench("EX9042D");
  std::fill(bench.module().memory().contents().begin(), bench.module().memory().contents().end(),
            std::uint8_t{0x5A});
  bench.tell("1 reset");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.tell("1 led"), "ok flashing");
  ASSERT_EQ(bench.ask("~01ONEW"), "!01");
  EXPECT_EQ(bench.tell("1 led"), "ok on");
}

TEST(ControlStatus, ReportsTheActiveSettings) {
  ControlBench ascii("EX9042D@1f,baud=115200,format=8E1,checksum=on");
  const std::string of_ascii = ascii.tell("1 status");
  for (const char* part : {"EX9042D", "address=1F", "protocol=ascii", "baud=115200", "format=8E1",
                           "checksum=on", "mode=normal", "host-watchdog=disabled"}) {
    EXPECT_TRUE(has(of_ascii, part)) << of_ascii;
  }
  ControlBench modbus("EX9068D-M@F7,baud=1200,init=off");
  const std::string of_modbus = modbus.tell("1 status");
  for (const char* part : {"EX9068D-M", "address=F7", "protocol=modbus", "baud=1200", "mode=normal"}) {
    EXPECT_TRUE(has(of_modbus, part)) << of_modbus;
  }
  ControlBench init("EX9068D-M@F7,baud=1200,init=on");
  const std::string of_init = init.tell("1 status");
  for (const char* part : {"address=00", "protocol=ascii", "baud=9600", "checksum=off", "mode=init"}) {
    EXPECT_TRUE(has(of_init, part)) << of_init;
  }
}

TEST(ControlStatus, ReportsTheStateOfTheHostWatchdog) {
  ControlBench bench("EX9042D");
  ASSERT_EQ(bench.ask("~01310A"), "!01");
  EXPECT_TRUE(bench.status_has("host-watchdog=enabled timeout=1.0s"));
  bench.run(milliseconds(1000));
  EXPECT_TRUE(bench.status_has("host-watchdog=expired"));
  ASSERT_EQ(bench.ask("~011"), "!01");
  EXPECT_TRUE(bench.status_has("host-watchdog=disabled"));
}

TEST(ControlStatus, ReportsTheResponseDelayTheInvertedInputsAndWhatFeedsTheHostWatchdog) {
  ControlBench bench("EX9055D");
  EXPECT_TRUE(bench.status_has("fed-by=host-ok response-delay=0ms inverted=0000"));
  ASSERT_EQ(bench.ask("~01X02510001"), "!01");
  ASSERT_EQ(bench.ask("~01RD1E"), "!01");
  ASSERT_EQ(bench.ask("~01X025000A1"), "!01");
  EXPECT_TRUE(bench.status_has("fed-by=requests response-delay=30ms inverted=00A1"));
}

TEST(ControlView, TheCommandTimersReturnsTheRemainingTimeOfEachOutput) {
  ControlBench bench("EX9063D");
  EXPECT_EQ(bench.tell("1 timers"), "ok 0 0 0");
  bench.send("~01X02810003\r");  // switches on output 1 for 0.3 s
  bench.run(milliseconds(150));
  EXPECT_EQ(bench.tell("1 timers"), "ok 0 2 0");
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.tell("1 timers"), "ok 0 0 0");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 timers"),
            "error: the module has no power; use 'power on', or end the fault that switches the supply off");
}

TEST(ControlView, TheCommandFiltersReturnsTheFilterOfEachInput) {
  ControlBench bench("EX9060D");
  ASSERT_EQ(bench.ask("~01X02400014"), "!01");
  ASSERT_EQ(bench.ask("~01X024307D0"), "!01");
  EXPECT_EQ(bench.tell("1 filters"), "ok 20 0 0 2000");
  EXPECT_EQ(bench.tell("1 timers"), "ok 0 0 0 0");
}

TEST(ControlStatus, IsReportedDuringStartAndWithoutPower) {
  ControlBench bench("EX9042D");
  bench.tell("1 reset");
  EXPECT_TRUE(bench.status_has("EX9042D"));
  EXPECT_TRUE(bench.status_has("mode=starting"));
  EXPECT_TRUE(has(bench.tell("list"), "EX9042D"));
  bench.tell("1 power off");
  EXPECT_TRUE(bench.status_has("EX9042D"));
  EXPECT_TRUE(bench.status_has("power=off"));
  EXPECT_TRUE(has(bench.tell("list"), "EX9042D"));
}

}  // namespace
}  // namespace ex9000::sim
