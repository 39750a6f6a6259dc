// Tests edges, latches and counters: wire.md section 5.
#include "firmware/channels/inputs.hpp"

#include <gtest/gtest.h>

namespace ex9000 {
namespace {

constexpr unsigned kAll = kMaxInputs;

class InputsTest : public testing::Test {
 protected:
  /// Sets the levels of the inputs at reset.
  void begin(std::uint16_t levels) {
    edges_.begin(levels);
    inputs_.begin(levels);
  }
  void rise(unsigned channel) { edges_.on_edge(channel, true, now_); }
  void fall(unsigned channel) { edges_.on_edge(channel, false, now_); }
  void pulse(unsigned channel, unsigned times) {
    for (unsigned i = 0; i < times; ++i) {
      rise(channel);
      fall(channel);
    }
  }
  void collect(unsigned channels = kAll) { inputs_.collect(edges_, channels, now_); }
  void pulse_and_collect(unsigned channel, unsigned times) {
    constexpr unsigned kAtOnce = 30'000;
    for (; times > kAtOnce; times -= kAtOnce) {
      pulse(channel, kAtOnce);
      collect();
    }
    pulse(channel, times);
    collect();
  }

  Time now_;
  InputEdges edges_;
  Inputs inputs_;
};

TEST_F(InputsTest, ARisingEdgeAtAHighLevelIsTreatedAsTwoEdges) {
  begin(0x0002);
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(false);
  rise(1);
  collect();
  EXPECT_EQ(inputs_.levels(), 0x0002);
  EXPECT_EQ(inputs_.latched_high(), 0x0002);
  EXPECT_EQ(inputs_.latched_low(), 0x0002);
  EXPECT_EQ(inputs_.counter(1), 1U);
}

TEST_F(InputsTest, AFallingEdgeAtALowLevelIsTreatedAsTwoEdges) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(true);
  fall(1);
  collect();
  EXPECT_EQ(inputs_.levels(), 0);
  EXPECT_EQ(inputs_.latched_high(), 0x0002);
  EXPECT_EQ(inputs_.latched_low(), 0x0002);
  EXPECT_EQ(inputs_.counter(1), 1U);
}

TEST_F(InputsTest, UpTo65535EdgesBetweenTwoCollectionsAreCounted) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(true);
  pulse(0, 32'767);
  rise(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 32'768U);
  EXPECT_EQ(inputs_.levels(), 0x0001);
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(false);
  inputs_.clear_counters(0x0001);
  fall(0);
  pulse(0, 32'767);
  collect();
  EXPECT_EQ(inputs_.counter(0), 32'768U);
  EXPECT_EQ(inputs_.levels(), 0);
}

// The interrupt counts rising and falling edges together. The main loop uses the previous level to find out
// which edge came first.
TEST_F(InputsTest, RisingAndFallingEdgesAreDistinguishedAtEitherLevelForOneToNineEdges) {
  for (const bool count_rising : {true, false}) {
    for (const bool high : {true, false}) {
      for (unsigned edges = 1; edges <= 9; ++edges) {
        InputEdges crossing;
        Inputs inputs;
        crossing.begin(high ? 0x0010 : 0x0000);
        inputs.begin(high ? 0x0010 : 0x0000);
        inputs.use_range(Inputs::CounterRange::SixteenBits);
        inputs.count_rising_edges(count_rising);
        unsigned rising = 0;
        bool level = high;
        for (unsigned i = 0; i < edges; ++i) {
          level = !level;
          rising += level ? 1 : 0;
          crossing.on_edge(4, level, now_);
        }
        inputs.collect(crossing, kAll, now_);
        EXPECT_EQ(inputs.counter(4), count_rising ? rising : edges - rising) << edges << " from " << high;
        EXPECT_EQ(inputs.latched_high(), rising != 0 ? 0x0010 : 0) << edges << " from " << high;
        EXPECT_EQ(inputs.latched_low(), edges != rising ? 0x0010 : 0) << edges << " from " << high;
        EXPECT_EQ(inputs.levels(), level ? 0x0010 : 0) << edges << " from " << high;
      }
    }
  }
}

TEST_F(InputsTest, TheTotalOfEdgesMayExceed65535) {
  pulse_and_collect(0, 65'530);
  pulse_and_collect(0, 20);
  EXPECT_EQ(inputs_.counter(0), 65'550U);
}

TEST_F(InputsTest, AnAsciiCounterMayWrapWithinOneCollection) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(false);
  pulse_and_collect(0, 99'990);
  pulse_and_collect(0, 25);
  EXPECT_EQ(inputs_.counter(0), 15U);
}

TEST_F(InputsTest, EdgesOfChannelsThatNoModelHasAreIgnored) {
  edges_.on_edge(16, true, now_);
  edges_.on_edge(31, true, now_);
  edges_.on_edge(1000, true, now_);
  collect();
  EXPECT_EQ(inputs_.levels(), 0);
  EXPECT_EQ(inputs_.latched_high(), 0);
}

}  // namespace
}  // namespace ex9000
