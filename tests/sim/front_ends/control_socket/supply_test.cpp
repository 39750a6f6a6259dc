// Tests the control socket's commands for power, reset, INIT* and a main loop that hangs, in virtual time.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

TEST(ControlPower, AfterOffTheOutputsAreOffAndTheModuleDoesNotReply) {
  ControlBench bench("EX9042D");
  ASSERT_EQ(bench.ask("@011FFF"), ">");
  EXPECT_EQ(bench.number("1 outputs"), 0x1FFFU);
  EXPECT_EQ(bench.tell("1 power off"), "ok");
  EXPECT_EQ(bench.number("1 outputs"), 0U);
  EXPECT_EQ(bench.ask("$01M"), "");
}

TEST(ControlPower, AfterOnTheOutputsHaveThePowerOnValueAndTheResetStatusIsSet) {
  ControlBench bench("EX9042D");
  bench.ask("@010A05");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  bench.ask("@010000");
  ASSERT_EQ(bench.ask("$015"), "!011");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 power on"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.number("1 outputs"), 0x0A05U);
  EXPECT_EQ(bench.ask("$015"), "!011");
}

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

TEST(ControlPower, OffDuringAWriteLeavesTheOldOrTheNewSettings) {
  for (int cut = 0; cut <= 12; ++cut) {
    ControlBench bench("EX9042D,name=OLD");
    bench.send("~01ONEW\r");
    bench.run(milliseconds(cut));
    bench.tell("1 power off");
    bench.tell("1 power on");
    bench.run(milliseconds(100));
    const std::string name = bench.ask("$01M");
    EXPECT_TRUE(name == "!01OLD" || name == "!01NEW") << name;
  }
}

TEST(ControlReset, DrivesThePowerOnValueSetsTheResetStatusAndClearsTheCountersAndTheLatches) {
  ControlBench bench("EX9055D");
  bench.tell("1 input 3 on");
  bench.tell("1 pulse 0 x7");
  bench.ask("@01FF");
  bench.ask("$015");
  ASSERT_EQ(bench.ask("#010"), "!0100007");
  EXPECT_EQ(bench.tell("1 reset"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$015"), "!011");
  EXPECT_EQ(bench.ask("@01"), ">0008");
  EXPECT_EQ(bench.ask("#010"), "!0100000");
  EXPECT_EQ(bench.ask("$01L1"), "!000000");  // a level at a reset is not an edge
  EXPECT_TRUE(bench.status_has("watchdog-resets=0"));
}

TEST(ControlInit, AChangeOfInitChangesTheModeAtTheNextReset) {
  ControlBench bench("EX9042D-M@0A");
  EXPECT_EQ(bench.tell("1 init on"), "ok");
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.status_has("mode=normal"));
  bench.tell("1 reset");
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.status_has("mode=init"));
  EXPECT_EQ(bench.ask("$002"), "!0A400600");
  EXPECT_EQ(bench.tell("1 init off"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$002"), "!0A400600");
  bench.tell("1 reset");
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.status_has("mode=normal"));
  EXPECT_EQ(bench.ask("$002"), "");
}

TEST(ControlInit, AModuleAcceptsCommandsThatRequireInitOnlyIfTheDebouncedInitIsAsserted) {
  ControlBench bench("EX9042D");
  EXPECT_EQ(bench.ask("%0101400700"), "?01");
  bench.tell("1 init on");
  bench.run(milliseconds(11));
  EXPECT_EQ(bench.ask("%0101400700"), "!01");
  bench.tell("1 init off");
  bench.run(milliseconds(11));
  EXPECT_EQ(bench.ask("%0101400600"), "?01");
}

TEST(ControlInit, CanBeSetBeforePowerOn) {
  ControlBench bench("EX9042D@0A");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 init on"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$00M"), "!009042D");
}

TEST(ControlHang, TheModuleWatchdogResetsAHungModuleWithin1600ms) {
  for (int moment = 0; moment < 400; moment += 37) {
    ControlBench bench("EX9042D");
    bench.ask("@010003");
    ASSERT_EQ(bench.ask("~015P"), "!01");
    bench.ask("@011FFF");
    bench.ask("$015");
    bench.run(milliseconds(moment));
    ASSERT_TRUE(bench.status_has("watchdog-resets=0"));
    EXPECT_EQ(bench.tell("1 hang"), "ok");
    const VirtualTime hung = bench.now();
    bench.run_to_reset();
    EXPECT_LE(bench.now() - hung, milliseconds(1600)) << moment;
    bench.run(milliseconds(100));
    EXPECT_TRUE(bench.status_has("watchdog-resets=1")) << moment;
    EXPECT_EQ(bench.number("1 outputs"), 3U);
    EXPECT_EQ(bench.ask("$015"), "!011");
  }
}

TEST(ControlHang, AHungModuleDoesNotReplyAndKeepsItsOutputs) {
  ControlBench bench("EX9042D");
  bench.ask("@011FFF");
  bench.tell("1 hang");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.ask("@010000"), "");
  EXPECT_EQ(bench.number("1 outputs"), 0x1FFFU);
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
