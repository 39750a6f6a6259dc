// Tests the timers of timed outputs: firmware/extensions.md.
#include "firmware/channels/output_timers.hpp"

#include <gtest/gtest.h>

namespace ex9000 {
namespace {

/// A timer runs this many microseconds longer than the requested time, because a pass of the main loop first
/// starts the timer and then switches the output on.
constexpr std::uint32_t kLate = 300;

class OutputTimersTest : public testing::Test {
 protected:
  void pass(Duration time) { now_ = now_ + time; }

  OutputTimers timers_;
  Time now_{0xFFFF'FF00U};  // the clock wraps soon
};

TEST_F(OutputTimersTest, TheLongestTimeIsExactAlthoughItExceedsTheRangeOfTheClock) {
  timers_.start(15, 0xFFFF, now_);
  for (unsigned unit = 1; unit <= 0xFFFF; ++unit) {
    pass(milliseconds(100));
    ASSERT_EQ(timers_.expire(now_), 0U) << unit;
  }
  EXPECT_EQ(timers_.left(15), 1U);
  pass(Duration(kLate));
  EXPECT_EQ(timers_.expire(now_), 0x8000U);
}

TEST_F(OutputTimersTest, SeveralUnitsMayPassBetweenTwoCalls) {
  timers_.start(0, 5, now_);
  pass(milliseconds(350));
  EXPECT_EQ(timers_.expire(now_), 0U);
  EXPECT_EQ(timers_.left(0), 2U);
  pass(milliseconds(1000));
  EXPECT_EQ(timers_.expire(now_), 1U);
}

}  // namespace
}  // namespace ex9000
