// Compares the results of DueTimes with those of a search through all stations.
#include "sim/virtual_line/wires/due_times.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace ex9000::sim {
namespace {

TEST(DueTimes, ResultsEqualThoseOfASearchThroughAllStations) {
  std::mt19937_64 random(1);
  DueTimes times;
  std::vector<VirtualTime> expected;
  const auto first_due = [&expected](VirtualTime now) {
    return std::find_if(expected.begin(), expected.end(), [now](VirtualTime when) { return when <= now; });
  };
  const auto set = [&](std::size_t station, VirtualTime when) {
    times.set(station, when);
    expected[station] = when;
  };
  for (unsigned step = 0; step < 20'000; ++step) {
    if (step % 400 == 0) {
      ASSERT_EQ(times.add(), expected.size());
      expected.push_back(kNever);
    }
    const VirtualTime now(step);
    for (std::uint64_t changes = random() % 3; changes != 0; --changes) {
      set(random() % expected.size(), random() % 4 == 0 ? kNever : now + VirtualTime(random() % 16));
    }
    ASSERT_EQ(times.next(), *std::min_element(expected.begin(), expected.end()));
    times.run_due(now, [&](std::size_t station) {
      const auto first = first_due(now);
      ASSERT_NE(first, expected.end());
      ASSERT_EQ(station, static_cast<std::size_t>(first - expected.begin()));
      *first = kNever;
      // A station may set its own time, times of other stations, or no time. A time may be due already.
      for (std::uint64_t changes = random() % 3; changes != 0; --changes) {
        set(random() % 2 == 0 ? station : random() % expected.size(), now + VirtualTime(random() % 4));
      }
    });
    ASSERT_EQ(first_due(now), expected.end());
    ASSERT_EQ(times.next(), *std::min_element(expected.begin(), expected.end()));
  }
}

}  // namespace
}  // namespace ex9000::sim
