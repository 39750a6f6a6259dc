// Tests the control socket's commands for inputs and pulses, in virtual time.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::milliseconds;

TEST(ControlInputs, EveryInputOfEveryModelHasItsOwnLevel) {
  for (const Model& model : kModels) {
    ControlBench bench(std::string(model.designation));
    unsigned levels = 0;
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      EXPECT_EQ(bench.tell("1 input " + std::to_string(channel) + " on"), "ok");
      levels |= 1U << channel;
      EXPECT_EQ(bench.number("1 inputs"), levels);
    }
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      EXPECT_EQ(bench.tell("1 input " + std::to_string(channel) + " off"), "ok");
      levels &= ~(1U << channel);
      EXPECT_EQ(bench.number("1 inputs"), levels);
    }
  }
}

TEST(ControlInputs, AModuleReadsTheLevelsAndItCountsAndLatchesTheEdges) {
  ControlBench bench("EX9052D");
  bench.tell("1 input 6 on");
  EXPECT_EQ(bench.ask("@01"), ">4000");
  EXPECT_EQ(bench.ask("$01L1"), "!400000");
  EXPECT_EQ(bench.ask("$01L0"), "!000000");
  bench.tell("1 input 6 on");
  bench.tell("1 input 6 off");
  EXPECT_EQ(bench.ask("@01"), ">0000");
  EXPECT_EQ(bench.ask("$01L0"), "!400000");
  EXPECT_EQ(bench.ask("#016"), "!0100001");
}

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
  struct Case {
    const char* count;
    const char* ascii;  ///< modulo 100000
    unsigned modbus;    ///< modulo 65536
  };
  const std::vector<Case> cases{
      {"1", "00001", 1},          {"1023", "01023", 1023},    {"1024", "01024", 1024},
      {"65535", "65535", 65535},  {"65536", "65536", 0},      {"99999", "99999", 34463},
      {"100000", "00000", 34464}, {"999999", "99999", 16959}, {"1000000", "00000", 16960}};
  for (const Case& pulses : cases) {
    ControlBench ascii("EX9052D");
    const VirtualTime before = ascii.now();
    EXPECT_EQ(ascii.tell(std::string("1 pulse 7 x") + pulses.count), "ok");
    EXPECT_EQ(ascii.now(), before);
    EXPECT_EQ(ascii.ask("#017"), std::string("!01") + pulses.ascii) << pulses.count;
    EXPECT_EQ(ascii.ask("#016"), "!0100000");
    ControlBench modbus("EX9052D-M");
    EXPECT_EQ(modbus.tell(std::string("1 pulse 0 x") + pulses.count), "ok");
    EXPECT_EQ(modbus.ask(Bytes{1, 0x04, 0, 0, 0, 1}),
              (Bytes{1, 0x04, 2, static_cast<std::uint8_t>(pulses.modbus >> 8U),
                     static_cast<std::uint8_t>(pulses.modbus & 0xFFU)}))
        << pulses.count;
  }
}

TEST(ControlPulse, AnInvalidCountIsRefused) {
  ControlBench bench("EX9052D");
  for (const char* count :
       {"0", "00", "1000001", "10000000", "999999999", "4294967296", "4294967297", "18446744073709551617",
        "99999999999999999999999999", "-1", "+1", "0x10", "1e3", "1.0", "1,000", "ten", "1 2", "1;"}) {
    bench.expect_refused(std::string("1 pulse 0 x") + count);
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
