// Tests faults of a module, in virtual time: a wrong rate, an interrupted supply and a hang. Also tests that
// faults survive a reset of the module.
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "tests/sim/virtual_line/faults/fault_bench.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

TEST(WrongRate, IsUsedForReceivingAndSending) {
  FaultBench bench(two());
  const std::size_t fault = bench.add("wrong-rate 19200", 1);
  EXPECT_NE(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$02M"), "!029052");
  bench.line().master().set_baud(19200);
  EXPECT_EQ(bench.ask("$01M"), kName);
  bench.line().master().set_baud(9600);
  EXPECT_TRUE(bench.faults().remove(fault));
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(WrongRate, AReplyKeepsItsRateIfTheFaultIsRemovedDuringTheReply) {
  FaultBench bench;
  const std::size_t fault = bench.add("wrong-rate 1200");
  bench.line().master().set_baud(1200);
  bench.send("$01M\r");
  bench.run(30ms);  // a character takes 8.3 ms
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.run(100ms);
  EXPECT_EQ(bench.heard(), kName + "\r");
  EXPECT_FALSE(bench.garbled());
}

TEST(Gone, SwitchesTheSupplyOffUntilTheFaultIsRemoved) {
  FaultBench bench;
  bench.ask("@010A05");
  bench.ask("$015");
  const std::size_t fault = bench.add("gone");
  EXPECT_FALSE(bench.at(1).powered());
  EXPECT_EQ(bench.at(1).outputs(), 0);
  EXPECT_EQ(bench.ask("@010001"), "");
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.run(100ms);
  EXPECT_EQ(bench.at(1).outputs(), 0);  // the command is not executed later
  EXPECT_EQ(bench.ask("$015"), "!011");
}

TEST(Gone, CutsOffAReplyInProgress) {
  FaultBench bench;
  bench.forget();
  bench.send("$01M\r");
  bench.run(5ms);
  bench.add("gone");
  bench.run(100ms);
  EXPECT_GT(bench.heard().size(), 0U);
  EXPECT_LT(bench.heard().size(), 6U);
  EXPECT_FALSE(bench.recorder().drivers.back().on);
}

TEST(Gone, DoesNotSwitchOnAModuleThatWasSwitchedOffSeparately) {
  for (const bool before : {true, false}) {
    FaultBench bench;
    if (before) {
      bench.at(1).power(false);
    }
    bench.add("gone for 2s");
    bench.run(1s);
    bench.at(1).power(false);
    bench.run(2s);
    EXPECT_FALSE(bench.at(1).powered()) << before;
    bench.at(1).power(true);
    EXPECT_TRUE(bench.at(1).powered());
  }
}

TEST(Gone, LastsEvenIfTheModuleIsSwitchedOn) {
  FaultBench bench;
  bench.add("gone for 2s");
  bench.run(1s);
  bench.at(1).power(true);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run(1s);
  EXPECT_TRUE(bench.at(1).powered());
}

TEST(PowerCut, LastsOneSecondOrTheGivenTime) {
  for (const auto& [text, lasts] : {std::pair("power-cut", 1000ms), std::pair("power-cut for 30ms", 30ms)}) {
    FaultBench bench;
    bench.add(text);
    const VirtualTime cut = bench.now();
    bench.run_until(cut + lasts - 1ns);
    EXPECT_FALSE(bench.at(1).powered()) << text;
    bench.run_until(cut + lasts);
    EXPECT_TRUE(bench.at(1).powered()) << text;
    bench.run(100ms);
    EXPECT_EQ(bench.ask("$015"), "!011");
  }
}

TEST(Hang, StopsRepliesUntilTheModuleWatchdogResetsTheModule) {
  FaultBench bench;
  bench.add("hang at 1s");
  bench.run_until(1s - 1ns);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 0U);
  bench.run_until(1s);
  EXPECT_EQ(bench.ask("$01M"), "");
  bench.run_until(1s + 1600ms);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
  bench.run(100ms);
  EXPECT_EQ(bench.ask("$01M"), kName);
  bench.run(10s);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
}

TEST(Hang, DoesNotStopTheReplyThatTriggersIt) {
  FaultBench bench;
  bench.add("hang every 2nd reply");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M"), "");
  bench.run(2s);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
}

/// Some ways to reset a module, each with its name.
const std::pair<const char*, std::function<void(FaultBench&)>> kResets[] = {
    {"reset", [](FaultBench& bench) { bench.at(1).reset(); }},
    {"supply",
     [](FaultBench& bench) {
       bench.at(1).power(false);
       bench.at(1).power(true);
     }},
    {"watchdog",
     [](FaultBench& bench) {
       bench.at(1).hang();
       bench.run(1600ms);
       ASSERT_EQ(bench.at(1).watchdog_resets(), 1U);
     }},
};

// Each of these functions returns whether the module shows the fault that the name of the function describes.
bool replies_are_lost(FaultBench& bench) { return bench.ask("$01M", 100ms).empty(); }
bool replies_are_late(FaultBench& bench) {
  return bench.ask("$01M", 50ms).empty() && bench.ask("", 100ms) == kName;
}
bool its_driver_is_late(FaultBench& bench) {
  const bool answers = bench.ask("$01M", 100ms) == kName;
  const WiresRecorder::Driver off = bench.recorder().drivers.back();
  return answers && !off.on && off.at - bench.recorder().bytes.back().end >= 20ms;
}
bool its_rate_is_wrong(FaultBench& bench) {
  const bool deaf = bench.ask("$01M") != kName;
  bench.line().master().set_baud(19200);
  const bool answers = bench.ask("$01M") == kName;
  bench.line().master().set_baud(9600);
  return deaf && answers;
}

TEST(Faults, OfAModuleSurviveItsReset) {
  const std::pair<const char*, bool (*)(FaultBench&)> faults[] = {
      {"lost-reply", replies_are_lost},
      {"late-reply 60ms", replies_are_late},
      {"late-driver 20ms", its_driver_is_late},
      {"wrong-rate 19200", its_rate_is_wrong},
  };
  for (const auto& [fault, affects] : faults) {
    for (const auto& [how, begin_anew] : kResets) {
      FaultBench bench;
      EXPECT_FALSE(affects(bench)) << fault;
      const std::size_t number = bench.add(fault);
      EXPECT_TRUE(affects(bench)) << fault;
      begin_anew(bench);
      bench.run(100ms);
      EXPECT_TRUE(affects(bench)) << fault << ", " << how;
      EXPECT_EQ(bench.faults().list().at(0).in_progress, 1U);
      bench.faults().remove(number);
      EXPECT_FALSE(affects(bench)) << fault << ", " << how;
    }
  }
}

}  // namespace
}  // namespace ex9000::sim
