// Tests the control socket's commands for power, reset, INIT* and a main loop that hangs, in virtual time.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

TEST(ControlPower, SettingTheCurrentStateHasNoEffect) {
  ControlBench bench("EX9042D");
  bench.ask("@010001");
  bench.ask("$015");
  EXPECT_EQ(bench.tell("1 power on"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.number("1 outputs"), 1U);
  EXPECT_EQ(bench.ask("$015"), "!010");
  EXPECT_EQ(bench.tell("1 power off"), "ok");
  EXPECT_EQ(bench.tell("1 power off"), "ok");
  EXPECT_EQ(bench.ask("$01M"), "");
}

TEST(ControlInit, CanBeSetBeforePowerOn) {
  ControlBench bench("EX9042D@0A");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 init on"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$00M"), "!009042D");
}

TEST(ControlHang, ASecondHangDoesNotDelayTheWatchdogReset) {
  ControlBench bench("EX9042D");
  bench.tell("1 hang");
  bench.run(milliseconds(900));
  EXPECT_EQ(bench.tell("1 hang"), "ok");
  bench.run(milliseconds(800));
  EXPECT_TRUE(bench.status_has("watchdog-resets=1"));
  bench.run(milliseconds(5000));
  EXPECT_TRUE(bench.status_has("watchdog-resets=1"));
  EXPECT_EQ(bench.ask("$01M"), "!019042D");
}

TEST(ControlHang, AResetOrAPowerCycleEndsAHang) {
  for (const bool cut : {false, true}) {
    ControlBench bench("EX9042D");
    bench.tell("1 hang");
    if (cut) {
      bench.tell("1 power off");
      bench.run(milliseconds(5000));
      bench.tell("1 power on");
    } else {
      bench.tell("1 reset");
    }
    bench.run(milliseconds(100));
    EXPECT_EQ(bench.ask("$01M"), "!019042D");
    bench.run(milliseconds(5000));
    EXPECT_TRUE(bench.status_has("watchdog-resets=0"));
  }
}

TEST(ControlHang, OtherCommandsWorkOnAHungModule) {
  ControlBench bench("EX9055D");
  bench.tell("1 hang");
  for (const char* command : {"1 input 0 on", "1 pulse 1 x100000", "1 init on", "1 init off", "1 inputs",
                              "1 outputs", "1 led", "1 status", "list", "1 power on"}) {
    EXPECT_EQ(bench.tell(command).rfind("ok", 0), 0U) << command;
  }
  EXPECT_EQ(bench.number("1 inputs"), 1U);
  bench.run(milliseconds(1800));
  EXPECT_EQ(bench.ask("@01"), ">0001");
}

TEST(ControlWithoutPower, ResetAndHangAreRefusedAndStatesCanBeRead) {
  ControlBench bench("EX9055D");
  bench.tell("1 power off");
  bench.expect_refused("1 reset");
  bench.expect_refused("1 hang");
  EXPECT_EQ(bench.number("1 inputs"), 0U);
  EXPECT_EQ(bench.number("1 outputs"), 0U);
  EXPECT_EQ(bench.tell("1 led"), "ok off");
  bench.run(milliseconds(5000));
  EXPECT_FALSE(bench.module().powered());
}

}  // namespace
}  // namespace ex9000::sim
