// Tests the control socket's commands for inputs and pulses, in virtual time.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

TEST(ControlInputs, LevelsSurviveAResetAndAPowerCycle) {
  ControlBench bench("EX9052D");
  bench.tell("1 input 1 on");
  bench.tell("1 reset");
  EXPECT_EQ(bench.number("1 inputs"), 2U);
  bench.tell("1 power off");
  EXPECT_EQ(bench.number("1 inputs"), 2U);
  EXPECT_EQ(bench.tell("1 input 7 on"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("@01"), ">8200");
}

TEST(ControlInputs, AChannelThatTheModelLacksIsRefused) {
  for (const Model& model : kModels) {
    ControlBench bench(std::string(model.designation));
    const std::string beyond = std::to_string(model.inputs);
    for (const std::string& command : {"1 input " + beyond + " on", "1 input " + beyond + " off",
                                       "1 pulse " + beyond, "1 pulse " + beyond + " 3"}) {
      bench.expect_refused(command);
      EXPECT_TRUE(has(bench.tell(command), std::string(model.designation))) << command;
    }
  }
}

TEST(ControlPulse, APulseMakesBothEdgesAndKeepsTheLevel) {
  for (const bool high : {false, true}) {
    for (const std::string edge : {"falling", "rising"}) {
      ControlBench bench("EX9052D,edge=" + edge);
      bench.tell(high ? "1 input 2 on" : "1 input 2 off");
      bench.ask("$01C");
      bench.ask("$01C2");
      EXPECT_EQ(bench.tell("1 pulse 2"), "ok");
      EXPECT_EQ(bench.number("1 inputs"), high ? 4U : 0U);
      EXPECT_EQ(bench.ask("@01"), high ? ">0400" : ">0000");
      EXPECT_EQ(bench.ask("$01L1"), "!040000");
      EXPECT_EQ(bench.ask("$01L0"), "!040000");
      EXPECT_EQ(bench.ask("#012"), "!0100001") << edge << high;
    }
  }
}

TEST(ControlPulse, UpToAMillionPulsesOfOneCommandAreCounted) {
  for (const auto& [count, counted] :  // modulo 100000
       {std::pair("1023", "01023"), std::pair("1024", "01024"), std::pair("65536", "65536"),
        std::pair("100000", "00000"), std::pair("999999", "99999"), std::pair("1000000", "00000")}) {
    ControlBench bench("EX9052D");
    const VirtualTime before = bench.now();
    EXPECT_EQ(bench.tell(std::string("1 pulse 7 x") + count), "ok");
    EXPECT_EQ(bench.now(), before);
    EXPECT_EQ(bench.ask("#017"), std::string("!01") + counted) << count;
    EXPECT_EQ(bench.ask("#016"), "!0100000");
  }
}

TEST(ControlPulse, PulsesWithoutPowerAreNotCounted) {
  ControlBench bench("EX9052D");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 pulse 0 x5"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("#010"), "!0100000");
}

}  // namespace
}  // namespace ex9000::sim
