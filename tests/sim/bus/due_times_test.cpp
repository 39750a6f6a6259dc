// Tests the queue of due times against a search through all stations.
#include "sim/bus/due_times.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace ex9000::sim {
namespace {

TEST(DueTimes, AreNeverWithoutStations) {
  DueTimes times;
  EXPECT_EQ(times.next(), kNever);
  EXPECT_EQ(times.take(VirtualTime(1)), std::nullopt);
}

TEST(DueTimes, AreTakenEarliestFirstAndInTheOrderOfTheStations) {
  DueTimes times;
  for (const int due : {30, 10, 20, 10, 40}) {
    times.set(times.add(), VirtualTime(due));
  }
  std::vector<std::size_t> taken;
  while (const auto station = times.take(VirtualTime(30))) {
    taken.push_back(*station);
  }
  EXPECT_EQ(taken, (std::vector<std::size_t>{1, 3, 2, 0}));
  EXPECT_EQ(times.next(), VirtualTime(40));
}

TEST(DueTimes, EqualThoseOfASearchThroughAllStations) {
  std::mt19937_64 random(1);
  DueTimes times;
  std::vector<VirtualTime> expected;
  for (unsigned step = 0; step < 20'000; ++step) {
    if (step % 1'000 == 0) {
      ASSERT_EQ(times.add(), expected.size());
      expected.push_back(kNever);
    }
    const std::size_t station = random() % expected.size();
    const VirtualTime when = random() % 4 == 0 ? kNever : VirtualTime(random() % 16);
    times.set(station, when);
    expected[station] = when;
    const auto first = std::min_element(expected.begin(), expected.end());
    ASSERT_EQ(times.next(), *first);
    if (random() % 4 == 0 && *first != kNever) {
      ASSERT_EQ(times.take(*first - VirtualTime(1)), std::nullopt);
      ASSERT_EQ(times.take(*first), static_cast<std::size_t>(first - expected.begin()));
      *first = kNever;
    }
  }
}

}  // namespace
}  // namespace ex9000::sim
