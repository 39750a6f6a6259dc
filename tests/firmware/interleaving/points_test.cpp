// Tests that interrupts at every point reveal two typical errors in code that shares data between the main
// loop and interrupts.
#include "tests/support/interleaving/points.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"

namespace ex9000::interleaving {
namespace {

TEST(Points, FindACountThatIsReadTwice) {
  unsigned lost = 0;
  unsigned points = 1;
  for (unsigned at = 0; at < points; ++at) {
    WrittenByInterrupt<std::uint32_t> total;
    std::uint32_t seen = 0;
    std::uint32_t fresh = 0;
    points = Points::watch(
        [&](unsigned point) {
          if (point == at) {
            Points::interrupt([&] { total.store_in_interrupt(total.load() + 1); });
          }
        },
        [&] {
          fresh = total.load() - seen;
          seen = total.load();
        });
    lost += total.load() - seen == 0 && fresh == 0 ? 1U : 0U;
  }
  EXPECT_EQ(lost, 2U);  // after the first load, and before the second
}

TEST(Points, FindAHandoverThatIsTorn) {
  HandedToInterrupt<Bytes> handed;
  EXPECT_THROW(Points::watch([&](unsigned) { Points::interrupt([&] { handed.in_interrupt() = {}; }); },
                             [&] { handed.set_in_main_loop({}); }),
               std::logic_error);
}

}  // namespace
}  // namespace ex9000::interleaving
