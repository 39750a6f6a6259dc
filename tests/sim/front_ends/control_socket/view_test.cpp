// Tests the replies of the control socket about LED, status, timers, filters and faults.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

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

TEST(ControlFault, BeginsImmediatelyAndFaultOffRemovesOneFaultOrAllFaults) {
  ControlBench bench("EX9042D");
  EXPECT_EQ(bench.tell("1 fault lost-reply"), "ok 1");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.tell("fault bit-errors 1e-9"), "ok 2");
  EXPECT_EQ(bench.tell("fault off 1"), "ok");
  EXPECT_EQ(bench.ask("$01M"), "!019042D");
  EXPECT_EQ(bench.tell("faults"), "ok 1 fault: 2* x1 bit-errors 1e-9");
  EXPECT_EQ(bench.tell("fault off all"), "ok");
  EXPECT_EQ(bench.tell("faults"), "ok 0 faults:");
  EXPECT_EQ(bench.tell("fault off all"), "ok");
}

}  // namespace
}  // namespace ex9000::sim
