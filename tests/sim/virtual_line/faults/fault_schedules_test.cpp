// Tests the schedules and the durations of faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/sim/virtual_line/faults/fault_bench.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

TEST(FaultsSchedule, ATimeIsExactAndCountsFromTheStartOfTheLine) {
  FaultBench bench;
  bench.add("gone at 12.5s for 2s");
  bench.run_until(12'500ms - 1ns);
  EXPECT_TRUE(bench.at(1).powered());
  bench.run_until(12'500ms);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(14'500ms - 1ns);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(14'500ms);
  EXPECT_TRUE(bench.at(1).powered());
}

TEST(FaultsSchedule, ATimeInThePastIsRefused) {
  FaultBench bench;
  bench.run_until(2s);
  EXPECT_EQ(refusal([&] { bench.add("gone at 1.5s"); }),
            "gone at 1.5s: the time has passed; expected a time from 2s on");
  EXPECT_TRUE(bench.faults().list().empty());
  EXPECT_EQ(bench.add("gone at 2s"), 1U);
  EXPECT_FALSE(bench.at(1).powered());
}

TEST(FaultsSchedule, APeriodIsExactAndCountsFromTheAdditionOfTheFault) {
  FaultBench bench;
  bench.run_until(700ms);
  bench.add("foreign-traffic 55 every 5s");
  bench.run_until(26s);
  const auto said = of_others(bench);
  ASSERT_EQ(said.size(), 5U);
  for (std::size_t i = 0; i < said.size(); ++i) {
    EXPECT_EQ(said[i].first, 700ms + 5s * (i + 1));
  }
}

TEST(FaultsSchedule, APeriodicFaultLastsItsDurationInEveryPeriod) {
  FaultBench bench;
  bench.run_until(1s);
  bench.add("gone every 5s for 1s");
  for (int i = 1; i <= 4; ++i) {
    bench.run_until(1s + 5s * i - 1ns);
    EXPECT_TRUE(bench.at(1).powered()) << i;
    bench.run_until(1s + 5s * i + 1s - 1ns);
    EXPECT_FALSE(bench.at(1).powered()) << i;
    bench.run_until(1s + 5s * i + 1s);
    EXPECT_TRUE(bench.at(1).powered()) << i;
  }
  EXPECT_EQ(bench.faults().list()[0].occurrences_so_far, 4U);
}

TEST(FaultsSchedule, AReplyFaultOccursAtEveryReplyOrEveryNthReply) {
  FaultBench every;
  every.add("lost-reply every reply");
  EXPECT_EQ(answered(every, 5), ".....");
  FaultBench tenth;
  tenth.add("lost-reply every 10th reply");
  EXPECT_EQ(answered(tenth, 35), "xxxxxxxxx.xxxxxxxxx.xxxxxxxxx.xxxxx");
  EXPECT_EQ(tenth.faults().list()[0].occurrences_so_far, 3U);
}

TEST(FaultsSchedule, TheRepliesOfAllModulesAreCountedTogether) {
  FaultBench bench(two());
  bench.add("lost-reply every 3rd reply");
  EXPECT_EQ(answered(bench, 2, "01"), "xx");
  EXPECT_EQ(answered(bench, 2, "02"), ".x");
  EXPECT_EQ(answered(bench, 2, "01"), "x.");
}

TEST(FaultsSchedule, OverlappingOccurrencesOfManyRepliesAreOneOccurrenceInProgress) {
  FaultBench bench;
  bench.add("late-reply 0s every reply for 1h");
  bench.add("late-driver 0s every reply for 1s");
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(bench.ask("$01M"), kName);
  }
  bench.run(990ms);
  EXPECT_EQ(bench.faults().list()[0].in_progress, 1U);
  EXPECT_EQ(bench.faults().list()[1].in_progress, 0U);
  EXPECT_EQ(bench.faults().list()[0].occurrences_so_far, 20U);
}

TEST(FaultsSchedule, AReplyFaultMayLastBeyondTheReply) {
  FaultBench bench;
  bench.add("lost-reply every 3rd reply for 100ms");
  const std::string which = answered(bench, 6);  // each request and the wait for its reply take about 55 ms
  EXPECT_EQ(which, "xx..x.");                    // the sixth reply triggers the fault again
}

TEST(FaultsSchedule, AReplyFaultHasItsProbabilityAndIsReproducibleFromTheSeed) {
  const auto which = [](std::uint64_t seed) {
    FaultBench bench({"EX9042D@01"}, seed);
    bench.add("lost-reply with probability 0.25");
    return answered(bench, 2000);
  };
  const std::string first = which(1);
  EXPECT_EQ(which(1), first);
  EXPECT_NE(which(2), first);
  const double lost = static_cast<double>(std::count(first.begin(), first.end(), '.')) / 2000;
  EXPECT_NEAR(lost, 0.25, 4 * std::sqrt(0.25 * 0.75 / 2000));
}

TEST(FaultsSchedule, APowerCutAfterWritesOccursAfterTheLastCountedWriteAndBeforeTheReply) {
  FaultBench bench;
  bench.add("power-cut after 3 writes");
  EXPECT_EQ(bench.ask("~01OFIRST"), "!01");
  EXPECT_EQ(bench.ask("~01OSECOND"), "!01");
  bench.ask("$01M");  // stores nothing
  EXPECT_EQ(bench.ask("~01OTHIRD"), "");
  EXPECT_FALSE(bench.at(1).powered());
  bench.run(1200ms);
  EXPECT_EQ(bench.ask("$01M"), "!01THIRD");
  EXPECT_EQ(bench.ask("~01OFOURTH"), "!01");  // the fault occurs only once
  EXPECT_EQ(bench.ask("~01OFIFTH"), "!01");
  EXPECT_EQ(bench.ask("~01OSIXTH"), "!01");
  EXPECT_EQ(bench.faults().list()[0].occurrences_so_far, 1U);
}

TEST(FaultsSchedule, AFaultOfOneModuleCountsOnlyTheWritesOfThisModule) {
  FaultBench bench(two());
  bench.add("gone after 1 write for 1s", 2);
  EXPECT_EQ(bench.ask("~01OOTHER"), "!01");
  EXPECT_TRUE(bench.at(2).powered());
  EXPECT_EQ(bench.ask("~02OMINE"), "");
  EXPECT_TRUE(bench.at(1).powered());
  bench.run(1200ms);
  EXPECT_EQ(bench.ask("$02M"), "!02MINE");
}

}  // namespace
}  // namespace ex9000::sim
