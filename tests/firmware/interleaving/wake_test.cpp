// Tests that an edge of an input with a filter wakes the main loop. Without this, an idle module would
// process the edge only at the next tick.
#include <gtest/gtest.h>

#include "tests/firmware/interleaving/bench.hpp"

namespace ex9000::interleaving {
namespace {

TEST(Wake, ALevelCountsAfterItsFilterTimeAlsoBetweenTwoTicks) {
  constexpr unsigned kChannel = 3;
  Bench bench("EX9052D", [](Settings& settings) { settings.input_filters.set(kChannel, 2); });
  bench.tick();  // the next tick is 10 ms later
  bench.rest(milliseconds(1));
  bench.edge(kChannel, true);
  bench.rest(milliseconds(1));
  EXPECT_EQ(bench.module().state().inputs.levels(), 0U);
  bench.rest(milliseconds(2));
  EXPECT_EQ(bench.module().state().inputs.levels(), 1U << kChannel);
  bench.edge(kChannel, false);
  bench.rest(milliseconds(3));
  EXPECT_EQ(bench.module().state().inputs.levels(), 0U);
}

}  // namespace
}  // namespace ex9000::interleaving
