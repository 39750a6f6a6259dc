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

TEST_F(InputsTest, TheLevelAtResetIsNoEdge) {
  begin(0x00A5);
  collect();
  EXPECT_EQ(inputs_.levels(), 0x00A5);
  EXPECT_EQ(inputs_.latched_high(), 0);
  EXPECT_EQ(inputs_.latched_low(), 0);
  for (unsigned channel = 0; channel < kAll; ++channel) {
    EXPECT_EQ(inputs_.counter(channel), 0U);
  }
}

TEST_F(InputsTest, ARisingEdgeRaisesTheLevelAndSetsLatchHigh) {
  for (unsigned channel = 0; channel < kAll; ++channel) {
    rise(channel);
    collect();
    EXPECT_EQ(inputs_.levels(), (1U << (channel + 1)) - 1);
    EXPECT_EQ(inputs_.latched_high(), (1U << (channel + 1)) - 1);
    EXPECT_EQ(inputs_.latched_low(), 0);
  }
}

TEST_F(InputsTest, AFallingEdgeLowersTheLevelAndSetsLatchLow) {
  begin(0x00FF);
  fall(3);
  collect();
  EXPECT_EQ(inputs_.levels(), 0x00F7);
  EXPECT_EQ(inputs_.latched_high(), 0);
  EXPECT_EQ(inputs_.latched_low(), 0x0008);
}

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

TEST_F(InputsTest, CountersCountRisingEdgesIfConfigured) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(true);
  rise(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 1U);
  fall(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 1U);
}

TEST_F(InputsTest, CountersCountFallingEdgesIfConfigured) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(false);
  rise(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 0U);
  fall(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 1U);
}

TEST_F(InputsTest, CountersCountFallingEdgesByDefault) {
  rise(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 0U);
  fall(0);
  collect();
  EXPECT_EQ(inputs_.counter(0), 1U);
}

TEST_F(InputsTest, EveryChannelHasItsOwnCounter) {
  for (unsigned channel = 0; channel < kAll; ++channel) {
    pulse(channel, channel + 1);
  }
  collect();
  for (unsigned channel = 0; channel < kAll; ++channel) {
    EXPECT_EQ(inputs_.counter(channel), channel + 1);
  }
}

TEST_F(InputsTest, EveryEdgeBetweenTwoCollectionsIsCountedOnce) {
  pulse(2, 1000);
  collect();
  collect();
  EXPECT_EQ(inputs_.counter(2), 1000U);
  pulse(2, 1);
  collect();
  EXPECT_EQ(inputs_.counter(2), 1001U);
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

TEST_F(InputsTest, TheLevelsAtResetAreKnownBeforeTheFirstCollection) {
  begin(0x00A5);
  EXPECT_EQ(inputs_.levels(), 0x00A5);
}

TEST_F(InputsTest, AnEdgeOnAnyChannelChangesTheTotalOfEdges) {
  for (unsigned channel = 0; channel < kAll; ++channel) {
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t before = edges_.edges();
      edges_.on_edge(channel, i == 0, now_);
      EXPECT_NE(edges_.edges(), before);
    }
  }
  const std::uint32_t before = edges_.edges();
  rise(kMaxInputs);
  EXPECT_EQ(edges_.edges(), before);
}

TEST_F(InputsTest, TheTotalOfEdgesMayExceed65535) {
  pulse_and_collect(0, 65'530);
  pulse_and_collect(0, 20);
  EXPECT_EQ(inputs_.counter(0), 65'550U);
}

TEST_F(InputsTest, AnAsciiCounterWrapsFrom99999To0) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(false);
  pulse_and_collect(0, 99'999);
  EXPECT_EQ(inputs_.counter(0), 99'999U);
  pulse_and_collect(0, 1);
  EXPECT_EQ(inputs_.counter(0), 0U);
  pulse_and_collect(0, 5);
  EXPECT_EQ(inputs_.counter(0), 5U);
}

TEST_F(InputsTest, AnAsciiCounterMayWrapWithinOneCollection) {
  inputs_.use_range(Inputs::CounterRange::FiveDigits);
  inputs_.count_rising_edges(false);
  pulse_and_collect(0, 99'990);
  pulse_and_collect(0, 25);
  EXPECT_EQ(inputs_.counter(0), 15U);
}

TEST_F(InputsTest, AModbusCounterWrapsFrom65535To0) {
  inputs_.use_range(Inputs::CounterRange::SixteenBits);
  inputs_.count_rising_edges(false);
  pulse_and_collect(0, 65'535);
  EXPECT_EQ(inputs_.counter(0), 65'535U);
  pulse_and_collect(0, 1);
  EXPECT_EQ(inputs_.counter(0), 0U);
  pulse_and_collect(0, 65'536 + 7);
  EXPECT_EQ(inputs_.counter(0), 7U);
}

TEST_F(InputsTest, AWrapDoesNotChangeAnotherCounter) {
  inputs_.use_range(Inputs::CounterRange::SixteenBits);
  inputs_.count_rising_edges(false);
  pulse_and_collect(1, 3);
  pulse_and_collect(0, 65'536);
  EXPECT_EQ(inputs_.counter(1), 3U);
}

TEST_F(InputsTest, LatchesStayUntilTheyAreCleared) {
  pulse(5, 1);
  collect();
  collect();
  EXPECT_EQ(inputs_.latched_high(), 0x0020);
  EXPECT_EQ(inputs_.latched_low(), 0x0020);
  inputs_.clear_latches();
  EXPECT_EQ(inputs_.latched_high(), 0);
  EXPECT_EQ(inputs_.latched_low(), 0);
}

TEST_F(InputsTest, ClearedLatchesStayClearWhileTheLevelDoesNotChange) {
  rise(0);
  collect();
  inputs_.clear_latches();
  collect();
  EXPECT_EQ(inputs_.levels(), 0x0001);
  EXPECT_EQ(inputs_.latched_high(), 0);
  EXPECT_EQ(inputs_.latched_low(), 0);
}

TEST_F(InputsTest, AfterTheLatchesAreClearedTheNextEdgeSetsItsLatch) {
  rise(0);
  collect();
  inputs_.clear_latches();
  fall(0);
  collect();
  EXPECT_EQ(inputs_.latched_high(), 0);
  EXPECT_EQ(inputs_.latched_low(), 0x0001);
}

TEST_F(InputsTest, ClearingLatchesDoesNotChangeCountersAndLevels) {
  pulse(0, 3);
  rise(1);
  collect();
  inputs_.clear_latches();
  EXPECT_EQ(inputs_.counter(0), 3U);
  EXPECT_EQ(inputs_.levels(), 0x0002);
}

TEST_F(InputsTest, ClearingTwoCountersDoesNotChangeTheOthers) {
  for (unsigned channel = 0; channel < kAll; ++channel) {
    pulse(channel, 9);
  }
  collect();
  inputs_.clear_counters(0x0024);
  for (unsigned channel = 0; channel < kAll; ++channel) {
    EXPECT_EQ(inputs_.counter(channel), channel == 2 || channel == 5 ? 0U : 9U) << channel;
  }
}

TEST_F(InputsTest, ClearingCountersDoesNotChangeTheLatches) {
  pulse(0, 1);
  collect();
  inputs_.clear_counters(0x00FF);
  EXPECT_EQ(inputs_.latched_high(), 0x0001);
  EXPECT_EQ(inputs_.latched_low(), 0x0001);
}

TEST_F(InputsTest, AClearedCounterCountsFrom0) {
  pulse(0, 100);
  collect();
  inputs_.clear_counters(0x0001);
  collect();
  EXPECT_EQ(inputs_.counter(0), 0U);
  pulse(0, 2);
  collect();
  EXPECT_EQ(inputs_.counter(0), 2U);
}

TEST_F(InputsTest, OnlyTheCountersOfTheMaskAreCleared) {
  pulse(0, 1);
  pulse(8, 2);
  pulse(15, 3);
  inputs_.collect(edges_, kMaxInputs, now_);
  inputs_.clear_counters(0x0100);
  EXPECT_EQ(inputs_.counter(0), 1U);
  EXPECT_EQ(inputs_.counter(8), 0U);
  EXPECT_EQ(inputs_.counter(15), 3U);
}

TEST_F(InputsTest, SixteenChannelsHaveALevelAndALatchHigh) {
  for (unsigned channel = 0; channel < 16; ++channel) {
    edges_.on_edge(channel, true, now_);
    inputs_.collect(edges_, 16, now_);
    EXPECT_EQ(inputs_.levels(), (2U << channel) - 1U);
    EXPECT_EQ(inputs_.latched_high(), (2U << channel) - 1U);
  }
}

TEST_F(InputsTest, EdgesOfChannelsThatNoModelHasAreIgnored) {
  edges_.on_edge(16, true, now_);
  edges_.on_edge(31, true, now_);
  edges_.on_edge(1000, true, now_);
  collect();
  EXPECT_EQ(inputs_.levels(), 0);
  EXPECT_EQ(inputs_.latched_high(), 0);
}

TEST_F(InputsTest, EdgesOfChannelsThatThisModelDoesNotHaveAreNotLatchedAndNotCounted) {
  constexpr unsigned kFourInputs = 4;
  pulse(4, 3);
  pulse(7, 3);
  pulse(3, 3);
  collect(kFourInputs);
  EXPECT_EQ(inputs_.latched_high(), 0x0008);
  EXPECT_EQ(inputs_.latched_low(), 0x0008);
  EXPECT_EQ(inputs_.counter(3), 3U);
  EXPECT_EQ(inputs_.counter(4), 0U);
  EXPECT_EQ(inputs_.counter(7), 0U);
}

// An edge interrupt may occur on a pin that the board has and the model does not use.
TEST_F(InputsTest, TheLevelOfAChannelThatThisModelDoesNotHaveIs0) {
  constexpr unsigned kFourInputs = 4;
  rise(7);
  rise(0);
  collect(kFourInputs);
  EXPECT_EQ(inputs_.levels(), 0x0001);
}

}  // namespace
}  // namespace ex9000
