// Tests the control socket's commands for faults.
#include <gtest/gtest.h>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

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

TEST(ControlFault, TheListShowsTheStateTheCountAndTheModuleOfEachFault) {
  ThreeModules modules;
  EXPECT_EQ(modules.tell("2 fault gone"), "ok 1");
  EXPECT_EQ(modules.tell("3 fault   power-cut \t after 3 writes"), "ok 2");
  EXPECT_EQ(modules.tell("fault lost-reply every 10th reply"), "ok 3");
  EXPECT_EQ(modules.tell("faults"),
            "ok 3 faults: 1* x1 2 gone; 2 x0 3 power-cut after 3 writes; 3 x0 lost-reply every 10th reply");
  EXPECT_FALSE(modules.at(2).powered());
  EXPECT_TRUE(modules.at(1).powered());
}

TEST(ControlFault, GoneIsIndependentOfThePowerSwitch) {
  ControlBench bench("EX9042D");
  bench.tell("1 fault gone");
  EXPECT_TRUE(bench.status_has("power=off"));
  bench.tell("1 power on");
  EXPECT_TRUE(bench.status_has("power=off"));
  bench.tell("fault off all");
  EXPECT_TRUE(bench.status_has("power=on"));
  bench.tell("1 fault gone");
  bench.tell("1 power off");
  bench.tell("fault off all");
  EXPECT_TRUE(bench.status_has("power=off"));
}

TEST(ControlFault, AnInvalidFaultCommandIsRefusedAndAddsNoFault) {
  ControlBench bench("EX9055D");
  for (const char* command : {"fault",
                              "1 fault",
                              "fault off",
                              "fault off 1",
                              "fault off 0",
                              "fault off -1",
                              "fault off 1 2",
                              "fault off all all",
                              "fault off ALL",
                              "fault off 99999999999999999999",
                              "faults 1",
                              "1 faults",
                              "1 fault off 1",
                              "2 fault gone",
                              "0 fault gone",
                              "fault bogus",
                              "fault gone at noon",
                              "fault gone every 1s",
                              "1 fault bit-errors 0.1",
                              "1 fault echo 2ms",
                              "1 fault foreign-traffic 00",
                              "fault gone at 1ms",
                              "1 fault wrong-rate 300",
                              "faultgone",
                              "line",
                              "line x",
                              "line x fault",
                              "line x fault gone"}) {
    bench.expect_refused(command);
    EXPECT_EQ(bench.tell("faults"), "ok 0 faults:") << command;
  }
}

TEST(ControlFault, ARefusalNamesTheErrorAndTheRemedy) {
  ControlBench bench("EX9055D");
  EXPECT_TRUE(has(bench.tell("fault lost"), "'lost' is not a fault; expected one of bit-errors, lost-bytes"));
  EXPECT_TRUE(has(bench.tell("1 fault bit-errors 1"),
                  "concerns the line, not a module; add it as a fault of the line"));
  EXPECT_TRUE(has(bench.tell("fault off 7"), "no fault 7 on this line"));
  EXPECT_TRUE(has(bench.tell("fault off"), "expected fault off K|all"));
  EXPECT_TRUE(has(bench.tell("fault gone at 1ms"), "the time has passed; expected a time from 100ms on"));
  EXPECT_TRUE(has(bench.tell("line hall faults"), "no line 'hall'; the only line has no name"));
}

}  // namespace
}  // namespace ex9000::sim
