// Tests which modules a fault affects, and the combined effect of several faults.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/virtual_line/faults/fault_bench.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

TEST(FaultsOfAModule, DoNotAffectOtherModules) {
  for (const char* trouble : {"lost-reply", "late-reply 30ms", "late-driver 5ms", "wrong-rate 1200", "gone",
                              "power-cut", "hang", "lost-reply every reply", "late-reply 30ms every reply",
                              "gone every reply for 5s", "hang every reply", "power-cut every reply",
                              "wrong-rate 1200 every reply for 5s", "late-driver 5ms every reply"}) {
    FaultBench bench(two());
    bench.add(trouble, 1);
    bench.ask("$01M", 200ms);
    EXPECT_EQ(bench.ask("$02M"), "!029052") << trouble;
    EXPECT_EQ(bench.ask("$02M"), "!029052") << trouble;
    EXPECT_TRUE(bench.at(2).powered()) << trouble;
  }
}

TEST(FaultsOfAllModules, AffectOnlyTheSenderOfTheReplyThatTriggersThem) {
  FaultBench bench(two());
  bench.add("gone every reply for 10s");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_FALSE(bench.at(1).powered());
  EXPECT_TRUE(bench.at(2).powered());
  const VirtualTime first = bench.now();
  bench.run(5s);
  EXPECT_EQ(bench.ask("$02M"), "");
  EXPECT_FALSE(bench.at(2).powered());
  EXPECT_FALSE(bench.at(1).powered());  // the occurrence on module 2 does not end the one on module 1
  bench.run_until(first + 10s);
  EXPECT_TRUE(bench.at(1).powered());
  EXPECT_FALSE(bench.at(2).powered());
  bench.run(6s);
  EXPECT_TRUE(bench.at(2).powered());
}

TEST(FaultsOfAModule, AreRefusedIfTheLineHasNoSuchModule) {
  FaultBench bench(two());
  EXPECT_EQ(refusal([&] { bench.add("gone", 3); }), "gone: no module 3; expected a position from 1 to 2");
  EXPECT_TRUE(bench.faults().list().empty());
}

TEST(SeveralFaultsOfAKind, TheOneThatWasAddedLastApplies) {
  FaultBench bench;
  bench.add("wrong-rate 19200");
  const std::size_t last = bench.add("wrong-rate 38400");
  bench.line().master().set_baud(38400);
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_TRUE(bench.faults().remove(last));
  bench.line().master().set_baud(19200);
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(SeveralFaultsOfAKind, TheEndOfOneDoesNotEndAnother) {
  FaultBench bench;
  const VirtualTime begin = bench.now();
  bench.add("gone for 2s");
  bench.add("power-cut");
  bench.run_until(begin + 2s - 1ns);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(begin + 2s);
  EXPECT_TRUE(bench.at(1).powered());
}

TEST(NoiseOfSeveralFaults, HasTheHighestProbability) {
  FaultBench bench;
  const std::size_t worst = bench.add("lost-bytes 1");
  bench.add("lost-bytes 1e-9");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_TRUE(bench.faults().remove(worst));
  EXPECT_EQ(bench.ask("$01M"), kName);
}

}  // namespace
}  // namespace ex9000::sim
