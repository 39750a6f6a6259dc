// Tests durations, times and deadlines on a clock that wraps at 2^32 microseconds.
#include "firmware/time.hpp"

#include <gtest/gtest.h>

namespace ex9000 {
namespace {

constexpr std::uint32_t kLast = 0xFFFF'FFFFU;
constexpr std::uint32_t kHalf = 0x8000'0000U;
constexpr Time kShortlyBeforeTheWrap{kLast - 99};

TEST(Duration, AMillisecondIs1000Microseconds) {
  EXPECT_EQ(milliseconds(0).microseconds(), 0U);
  EXPECT_EQ(milliseconds(1).microseconds(), 1000U);
  EXPECT_EQ(milliseconds(25'500).microseconds(), 25'500'000U);
}

TEST(Duration, IsOrderedByLength) {
  EXPECT_TRUE(Duration(1) < Duration(2));
  EXPECT_FALSE(Duration(2) < Duration(2));
  EXPECT_FALSE(Duration(2) < Duration(1));
  EXPECT_TRUE(Duration(0) < Duration(kLast));
}

TEST(Duration, IsEqualOnlyToADurationOfTheSameLength) {
  EXPECT_TRUE(Duration(1000) == milliseconds(1));
  EXPECT_FALSE(Duration(999) == milliseconds(1));
}

TEST(Duration, ASumHasTheMicrosecondsOfBothDurations) {
  EXPECT_EQ((Duration(40) + milliseconds(2)).microseconds(), 2040U);
}

TEST(Time, ReturnsTheMicrosecondsOfItsConstructor) {
  EXPECT_EQ(Time().microseconds(), 0U);
  EXPECT_EQ(Time(kLast).microseconds(), kLast);
}

TEST(Time, GivesTheDurationSinceAnEarlierOrEqualTime) {
  EXPECT_EQ(Time(500).since(Time(200)).microseconds(), 300U);
  EXPECT_EQ(Time(500).since(Time(500)).microseconds(), 0U);
}

TEST(Time, GivesTheDurationAcrossTheWrap) {
  EXPECT_EQ(Time(0).since(Time(kLast)).microseconds(), 1U);
  EXPECT_EQ(Time(200).since(kShortlyBeforeTheWrap).microseconds(), 300U);
}

TEST(Time, TheLongestDurationIsOneMicrosecondShorterThanTheRangeOfTheClock) {
  EXPECT_EQ(Time(4999).since(Time(5000)).microseconds(), kLast);
}

TEST(Time, AddsADurationAlsoAcrossTheWrap) {
  EXPECT_EQ((Time(200) + Duration(300)).microseconds(), 500U);
  EXPECT_EQ((kShortlyBeforeTheWrap + Duration(100)).microseconds(), 0U);
  EXPECT_EQ((kShortlyBeforeTheWrap + Duration(130)).microseconds(), 30U);
}

TEST(Time, SubtractsADurationAlsoAcrossTheWrap) {
  EXPECT_EQ((Time(1000) - Duration(400)).microseconds(), 600U);
  EXPECT_EQ((Time(49) - Duration(50)).microseconds(), kLast);
}

TEST(Deadline, IsNeverReachedBeforeItIsSet) {
  const Deadline deadline;
  EXPECT_FALSE(deadline.armed());
  EXPECT_FALSE(deadline.reached(Time(0)));
  EXPECT_FALSE(deadline.reached(Time(kHalf)));
}

TEST(Deadline, IsReachedAtItsTimeAndNotAMicrosecondBefore) {
  Deadline deadline;
  deadline.set(Time(1000));
  EXPECT_TRUE(deadline.armed());
  EXPECT_FALSE(deadline.reached(Time(999)));
  EXPECT_TRUE(deadline.reached(Time(1000)));
  EXPECT_TRUE(deadline.reached(Time(1001)));
}

TEST(Deadline, IsReachedAcrossTheWrap) {
  Deadline deadline;
  deadline.set(kShortlyBeforeTheWrap + Duration(150));
  EXPECT_FALSE(deadline.reached(kShortlyBeforeTheWrap));
  EXPECT_FALSE(deadline.reached(Time(kLast)));
  EXPECT_FALSE(deadline.reached(Time(49)));
  EXPECT_TRUE(deadline.reached(Time(50)));
}

TEST(Deadline, StaysReachedAcrossTheWrap) {
  Deadline deadline;
  deadline.set(Time(kLast));
  EXPECT_FALSE(deadline.reached(Time(kLast - 1)));
  EXPECT_TRUE(deadline.reached(Time(kLast)));
  EXPECT_TRUE(deadline.reached(Time(0)));
}

TEST(Deadline, IsAheadForHalfTheRangeAndReachedForTheOtherHalf) {
  Deadline deadline;
  deadline.set(Time(kHalf));
  EXPECT_FALSE(deadline.reached(Time(0)));
  EXPECT_TRUE(deadline.reached(Time(kLast)));
}

TEST(Deadline, GivesTheRemainingTime) {
  Deadline deadline;
  deadline.set(Time(1000));
  EXPECT_EQ(deadline.remaining(Time(400)).microseconds(), 600U);
  EXPECT_EQ(deadline.remaining(Time(999)).microseconds(), 1U);
}

TEST(Deadline, HasNoRemainingTimeIfItIsReached) {
  Deadline deadline;
  deadline.set(Time(1000));
  EXPECT_EQ(deadline.remaining(Time(1000)).microseconds(), 0U);
  EXPECT_EQ(deadline.remaining(Time(5000)).microseconds(), 0U);
}

TEST(Deadline, GivesTheRemainingTimeAcrossTheWrap) {
  Deadline deadline;
  deadline.set(Time(50));
  EXPECT_EQ(deadline.remaining(kShortlyBeforeTheWrap).microseconds(), 150U);
}

TEST(Deadline, AdvancesToAnEarlierDeadlineAlsoAcrossTheWrap) {
  Deadline deadline;
  deadline.advance_to(Deadline());
  EXPECT_FALSE(deadline.armed());
  for (const auto& [other, expected] : {std::pair{50U, 50U}, {51U, 50U}, {kLast, kLast}, {0U, kLast}}) {
    deadline.advance_to(Deadline(Time(other)));
    deadline.advance_to(Deadline());
    EXPECT_EQ(deadline.remaining(kShortlyBeforeTheWrap).microseconds(),
              Time(expected).since(kShortlyBeforeTheWrap).microseconds())
        << other;
  }
}

TEST(Deadline, IsDelayedToALaterDeadlineAlsoAcrossTheWrap) {
  Deadline deadline{Time(kLast)};
  for (const auto& [other, expected] : {std::pair{kLast - 1U, kLast}, {50U, 50U}, {49U, 50U}}) {
    deadline.delay_to(Deadline(Time(other)));
    deadline.delay_to(Deadline());
    EXPECT_EQ(deadline.remaining(kShortlyBeforeTheWrap).microseconds(),
              Time(expected).since(kShortlyBeforeTheWrap).microseconds())
        << other;
  }
}

TEST(Deadline, IsNotReachedAfterItIsDisarmed) {
  Deadline deadline;
  deadline.set(Time(1000));
  deadline.disarm();
  EXPECT_FALSE(deadline.armed());
  EXPECT_FALSE(deadline.reached(Time(1000)));
}

TEST(Deadline, IsReachedOnlyAtItsNewTimeIfItIsSetAgain) {
  Deadline deadline;
  deadline.set(Time(1000));
  deadline.set(Time(2000));
  EXPECT_FALSE(deadline.reached(Time(1500)));
  deadline.disarm();
  deadline.set(Time(3000));
  EXPECT_TRUE(deadline.reached(Time(3000)));
}

}  // namespace
}  // namespace ex9000
