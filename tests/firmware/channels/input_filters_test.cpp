// Tests the filters and the inversion of inputs: firmware/extensions.md.
#include <gtest/gtest.h>

#include "firmware/channels/inputs.hpp"

namespace ex9000 {
namespace {

constexpr Duration kLong = milliseconds(10'000);
constexpr unsigned kChannel = 5;
constexpr std::uint16_t kBit = 1U << kChannel;

class InputFiltersTest : public testing::Test {
 protected:
  void use_filter(std::uint16_t milliseconds, unsigned channel = kChannel) {
    filters_.set(channel, milliseconds);
    inputs_.use_filters(filters_, now_);
  }
  void edge(bool level, unsigned channel = kChannel) { edges_.on_edge(channel, level, now_); }
  /// Lets time pass and collects the edges.
  void pass(Duration time) {
    now_ = now_ + time;
    inputs_.collect(edges_, kMaxInputs, now_);
  }
  [[nodiscard]] bool high(unsigned channel = kChannel) const {
    return (inputs_.levels() >> channel & 1U) != 0;
  }
  [[nodiscard]] Duration until_settled() const {
    const Deadline& next = inputs_.next_settling();
    return next.armed() ? next.remaining(now_) : kLong;
  }

  Time now_{0xFFFF'FF00U};  // the clock wraps soon
  InputFilters filters_;
  InputEdges edges_;
  Inputs inputs_;
};

TEST_F(InputFiltersTest, ALevelIsAcceptedAfterTheFilterTimeAndNeverEarlier) {
  for (const std::uint16_t time : std::initializer_list<std::uint16_t>{1, 20, 2000}) {
    use_filter(time);
    const bool level = !high();
    const std::uint32_t counted = inputs_.long_counter(kChannel);
    edge(level);
    pass(milliseconds(time));
    EXPECT_NE(high(), level) << time;  // the edge may have occurred up to 1 us after its recorded time
    EXPECT_EQ(until_settled().microseconds(), 1U);
    pass(Duration(1));
    EXPECT_EQ(high(), level) << time;
    EXPECT_TRUE(until_settled() == kLong);
    EXPECT_EQ(inputs_.long_counter(kChannel), counted + (level ? 0 : 1)) << time;
  }
}

TEST_F(InputFiltersTest, APulseThatEndsBeforeTheNextCollectionRestartsTheFilterTime) {
  use_filter(10);
  edge(true);
  pass(milliseconds(9));
  edge(false);
  edge(true);
  pass(milliseconds(9));
  EXPECT_FALSE(high());
  EXPECT_EQ(until_settled().microseconds(), 1001U);
  pass(milliseconds(2));
  EXPECT_TRUE(high());
  EXPECT_EQ(inputs_.latched_high(), kBit);
  EXPECT_EQ(inputs_.latched_low(), 0U);
}

TEST_F(InputFiltersTest, APulseThatIsShorterThanTheFilterTimeDoesNotCount) {
  use_filter(10);
  edge(true);
  pass(milliseconds(9));
  edge(false);
  EXPECT_FALSE(until_settled() == kLong);
  pass(milliseconds(100));
  EXPECT_FALSE(high());
  EXPECT_EQ(inputs_.latched_high(), 0U);
  EXPECT_EQ(inputs_.counter(kChannel), 0U);
  EXPECT_TRUE(until_settled() == kLong);
}

TEST_F(InputFiltersTest, AChannelWithoutAFilterCountsEveryPulse) {
  use_filter(2000);
  edge(true);
  for (int i = 0; i < 7; ++i) {
    edge(true, 3);
    edge(false, 3);
  }
  pass(Duration(1));
  EXPECT_EQ(inputs_.counter(3), 7U);
  EXPECT_EQ(inputs_.counter(kChannel), 0U);
}

TEST_F(InputFiltersTest, ANewFilterTimeAppliesFromTheLastEdge) {
  use_filter(100);
  edge(true);
  pass(milliseconds(50));
  use_filter(51);
  pass(Duration());
  EXPECT_FALSE(high());
  pass(milliseconds(1));
  pass(Duration(1));
  EXPECT_TRUE(high());
}

TEST_F(InputFiltersTest, ALevelIsAcceptedImmediatelyIfTheNewFilterTimeIsOver) {
  for (const std::uint16_t time : std::initializer_list<std::uint16_t>{0, 1, 49}) {
    use_filter(100);
    const bool level = !high();
    edge(level);
    pass(milliseconds(50));
    ASSERT_NE(high(), level);
    use_filter(time);
    pass(Duration());
    EXPECT_EQ(high(), level) << time;
  }
  EXPECT_EQ(inputs_.long_counter(kChannel), 1U);  // only one of the three edges was a falling edge
}

TEST_F(InputFiltersTest, AfterTheFilterIsSwitchedOffEveryEdgeCountsAgain) {
  use_filter(100);
  edge(true);
  pass(milliseconds(1));
  use_filter(0);
  edge(false);
  edge(true);
  pass(Duration());
  EXPECT_TRUE(high());
  EXPECT_EQ(inputs_.counter(kChannel), 1U);
}

TEST_F(InputFiltersTest, AChangeOfTheInversionFlipsTheLevelWithoutAnEdge) {
  edge(true, 0);
  pass(Duration(1));
  const std::uint16_t latched = inputs_.latched_high();
  inputs_.invert(0x8001);
  pass(milliseconds(10));
  EXPECT_EQ(inputs_.levels(), 0x8000U);
  EXPECT_EQ(inputs_.latched_high(), latched);
  EXPECT_EQ(inputs_.latched_low(), 0U);
  EXPECT_EQ(inputs_.counter(0), 0U);
  inputs_.invert(0);
  EXPECT_EQ(inputs_.levels(), 0x0001U);
}

TEST_F(InputFiltersTest, AnInvertedChannelCountsTheOppositeEdges) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(true);
  inputs_.invert(kBit);
  edge(true);
  pass(Duration(1));
  EXPECT_EQ(inputs_.counter(kChannel), 0U);
  EXPECT_EQ(inputs_.latched_low(), kBit);
  edge(false);
  pass(Duration(1));
  EXPECT_EQ(inputs_.counter(kChannel), 1U);
  EXPECT_EQ(inputs_.latched_high(), kBit);
}

TEST_F(InputFiltersTest, AChangeOfTheInversionDoesNotStopTheFilterTime) {
  use_filter(10);
  edge(true);
  pass(milliseconds(5));
  inputs_.invert(kBit);
  EXPECT_TRUE(high());
  pass(milliseconds(5));
  pass(Duration(1));
  EXPECT_FALSE(high());
  EXPECT_EQ(inputs_.latched_low(), kBit);
  EXPECT_EQ(inputs_.latched_high(), 0U);
  EXPECT_EQ(inputs_.counter(kChannel), 1U);  // the falling edge
}

}  // namespace
}  // namespace ex9000
