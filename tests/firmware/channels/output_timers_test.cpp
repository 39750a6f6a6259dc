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

TEST_F(OutputTimersTest, NoTimerRunsAtFirst) {
  EXPECT_EQ(timers_.running(), 0U);
  EXPECT_EQ(timers_.left(0), 0U);
  EXPECT_EQ(timers_.expire(now_), 0U);
  EXPECT_TRUE(!timers_.next_end().armed());
}

TEST_F(OutputTimersTest, EachTimerEndsAfterItsTimeAndNeverEarly) {
  for (unsigned channel = 0; channel < kMaxOutputs; ++channel) {
    timers_.start(channel, static_cast<std::uint16_t>(channel + 1), now_);
  }
  EXPECT_EQ(timers_.running(), 0xFFFFU);
  for (unsigned channel = 0; channel < kMaxOutputs; ++channel) {
    pass(Duration(100'000 + kLate - 1));
    EXPECT_EQ(timers_.expire(now_), 0U) << channel;
    pass(Duration(1));
    EXPECT_EQ(timers_.expire(now_), 1U << channel);
    now_ = Time(now_.microseconds() - kLate);
  }
  EXPECT_EQ(timers_.running(), 0U);
}

TEST_F(OutputTimersTest, TheRemainingTimeIsRoundedUp) {
  timers_.start(3, 3, now_);
  EXPECT_EQ(timers_.left(3), 3U);
  pass(milliseconds(100));
  timers_.expire(now_);
  EXPECT_EQ(timers_.left(3), 3U);
  pass(Duration(kLate));
  timers_.expire(now_);
  EXPECT_EQ(timers_.left(3), 2U);
  EXPECT_EQ(timers_.left(2), 0U);
}

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

TEST_F(OutputTimersTest, ATimerThatIsStartedAgainRunsForItsNewTime) {
  timers_.start(1, 1, now_);
  pass(milliseconds(90));
  timers_.start(1, 2, now_);
  pass(milliseconds(200));
  EXPECT_EQ(timers_.expire(now_), 0U);
  pass(Duration(kLate));
  EXPECT_EQ(timers_.expire(now_), 2U);
}

TEST_F(OutputTimersTest, AStoppedTimerDoesNotExpire) {
  timers_.start(1, 1, now_);
  timers_.start(2, 1, now_);
  timers_.stop(1U << 1U);
  EXPECT_EQ(timers_.running(), 1U << 2U);
  EXPECT_EQ(timers_.left(1), 0U);
  pass(milliseconds(1000));
  EXPECT_EQ(timers_.expire(now_), 1U << 2U);
}

TEST_F(OutputTimersTest, UntilDueReturnsTheTimeToTheEarliestEndOfAUnit) {
  timers_.start(7, 9, now_);
  pass(milliseconds(30));
  timers_.start(2, 9, now_);
  EXPECT_EQ(timers_.next_end().remaining(now_).microseconds(), 70'000U + kLate);
  pass(milliseconds(75));
  EXPECT_TRUE(timers_.next_end().reached(now_));
  timers_.expire(now_);
  EXPECT_EQ(timers_.next_end().remaining(now_).microseconds(), 25'000U + kLate);
}

}  // namespace
}  // namespace ex9000
