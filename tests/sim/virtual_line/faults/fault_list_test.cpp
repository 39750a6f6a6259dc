// Tests the list of faults, their removal, their notices and their reproducibility.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/sim/virtual_line/faults/fault_bench.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

TEST(FaultsList, ARemovedFaultHasNoFurtherEffect) {
  for (const char* trouble :
       {"bit-errors 1", "lost-bytes 1", "inserted-bytes 1", "echo 5ms", "lost-reply", "late-reply 1s",
        "wrong-rate 1200", "gone", "power-cut for 1h", "lost-reply every reply", "gone every 10ms for 5ms"}) {
    for (const bool all : {false, true}) {
      FaultBench bench;
      const std::size_t fault = bench.add(trouble);
      EXPECT_NE(bench.ask("$01M"), kName) << trouble;
      if (all) {
        bench.faults().remove_all();
      } else {
        EXPECT_TRUE(bench.faults().remove(fault));
      }
      EXPECT_TRUE(bench.faults().list().empty());
      bench.run(2s);
      bench.send("\r");  // ends a frame, if one has begun
      EXPECT_EQ(bench.ask("$01M"), kName) << trouble;
    }
  }
}

TEST(FaultsList, FaultNumbersAreNeverReused) {
  FaultBench bench;
  EXPECT_EQ(bench.add("lost-reply at 1h"), 1U);
  EXPECT_EQ(bench.add("lost-reply at 2h"), 2U);
  EXPECT_TRUE(bench.faults().remove(1));
  EXPECT_FALSE(bench.faults().remove(1));
  EXPECT_FALSE(bench.faults().remove(0));
  EXPECT_FALSE(bench.faults().remove(3));
  EXPECT_EQ(bench.add("lost-reply at 3h"), 3U);
  bench.faults().remove_all();
  EXPECT_EQ(bench.add("lost-reply"), 4U);
}

TEST(FaultsList, KeepsTheLastFaultsThatHaveEndedByThemselves) {
  FaultBench bench;
  const std::size_t stays = bench.add("lost-reply at 1h");
  for (int i = 0; i < 200; ++i) {
    bench.add("foreign-traffic 41 at 1s");
    bench.add("gone at 1s for 10ms");
  }
  bench.run_until(2s);
  const std::vector<Faults::Info> infos = bench.faults().list();
  ASSERT_EQ(infos.size(), 1U + Faults::kMostEnded);
  EXPECT_EQ(infos[0].number, stays);
  EXPECT_EQ(infos[0].occurrences_so_far, 0U);
  for (std::size_t i = 1; i < infos.size(); ++i) {
    EXPECT_EQ(infos[i].in_progress, 0U);
    EXPECT_EQ(infos[i].occurrences_so_far, 1U);
    EXPECT_LT(infos[i - 1].number, infos[i].number);
  }
  EXPECT_TRUE(bench.faults().remove(infos[1].number));
  EXPECT_EQ(bench.faults().list().size(), std::size_t{Faults::kMostEnded});
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(FaultsList, ReportsTheOccurrencesInProgressAndAllOccurrencesSoFar) {
  FaultBench bench(two());
  bench.add("gone at 1s for 1s", 2);
  bench.add("lost-reply every reply", 1);
  bench.ask("$01M");
  bench.run_until(1500ms);
  const std::vector<Faults::Info> infos = bench.faults().list();
  ASSERT_EQ(infos.size(), 2U);
  EXPECT_EQ(infos[0].number, 1U);
  EXPECT_EQ(infos[0].text, "gone at 1s for 1s");
  EXPECT_EQ(infos[0].module, 1U);
  EXPECT_EQ(infos[0].in_progress, 1U);
  EXPECT_EQ(infos[0].occurrences_so_far, 1U);
  EXPECT_EQ(infos[1].in_progress, 0U);
  EXPECT_EQ(infos[1].occurrences_so_far, 1U);
  bench.run_until(2s);
  EXPECT_EQ(bench.faults().list()[0].in_progress, 0U);
}

TEST(FaultsNotice, IsGivenForTimedFaultsButNotForPermanentOrReplyFaults) {
  FaultBench bench;
  bench.add("lost-reply every reply");
  bench.add("lost-bytes 1e-9");
  bench.add("gone at 1s for 1s");
  bench.add("hang at 5s");
  bench.ask("$01M");
  EXPECT_EQ(bench.notices(), std::vector<std::string>());
  bench.run_until(10s);
  EXPECT_EQ(bench.notices(),
            (std::vector<std::string>{"fault 3 occurs: gone at 1s for 1s",
                                      "fault 3 is over: gone at 1s for 1s", "fault 4 occurs: hang at 5s"}));
}

TEST(FaultsTogether, TheSameSeedAndRequestsProduceTheSameBytes) {
  const auto all_heard = [](std::uint64_t seed) {
    FaultBench bench(two(), seed);
    for (const char* fault :
         {"bit-errors 1e-3", "inserted-bytes 0.01", "lost-bytes 0.01", "late-reply 7ms with probability 0.3",
          "lost-reply with probability 0.1", "gone every 5s for 300ms", "foreign-traffic 0102 every 777ms"}) {
      bench.add(fault);
    }
    std::string heard;
    for (int i = 0; i < 100; ++i) {
      heard += bench.ask(i % 2 == 0 ? "$01M" : "$02M") + "|";
    }
    return heard;
  };
  EXPECT_EQ(all_heard(1), all_heard(1));
  EXPECT_NE(all_heard(1), all_heard(2));
}

}  // namespace
}  // namespace ex9000::sim
