// Tests the effect of each fault of the line, in virtual time.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/text/durations.hpp"
#include "tests/sim/virtual_line/faults/fault_bench.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;
using namespace std::string_literals;

TEST(BitErrors, OccurWithTheGivenProbability) {
  FaultBench bench;
  const double probability = 1e-3;
  bench.add("bit-errors 1e-3");
  constexpr int kRequests = 2000;
  int whole = 0;
  for (int i = 0; i < kRequests; ++i) {
    whole += bench.ask("$01M") == kName && !bench.garbled() ? 1 : 0;
    bench.send("\r");  // ends a frame, if one has begun
  }
  // Each request is "$01M\r", and each reply is "!019042D\r". A character has ten bits.
  const double expected = std::pow(1 - probability, 10 * (5 + 9));
  const double deviation = std::sqrt(expected * (1 - expected) / kRequests);
  EXPECT_NEAR(whole / double{kRequests}, expected, 4 * deviation);
}

TEST(LostBytes, OfARequestAreNotReceivedByTheModule) {
  FaultBench bench;
  bench.add("lost-bytes 1");
  EXPECT_EQ(bench.ask("@010001"), "");
  EXPECT_EQ(bench.at(1).outputs(), 0);
  EXPECT_FALSE(bench.garbled());
}

TEST(LostBytes, OccurWithTheGivenProbability) {
  FaultBench bench;
  bench.add("lost-bytes 0.01");
  constexpr int kRequests = 2000;
  int unheard = 0;
  for (int i = 0; i < kRequests; ++i) {
    unheard += bench.ask("$01M").empty() ? 1 : 0;
    bench.send("\r");  // ends a frame, if one has begun
  }
  const double expected = 1 - std::pow(0.99, 5);  // the five characters of "$01M\r"
  const double deviation = std::sqrt(expected * (1 - expected) / kRequests);
  EXPECT_NEAR(unheard / double{kRequests}, expected, 4 * deviation);
}

TEST(InsertedBytes, FollowEveryByteImmediatelyAtProbability1) {
  FaultBench bench;
  bench.add("inserted-bytes 1");
  bench.send("\r");
  const VirtualTime sent = bench.now();
  bench.run(10ms);
  ASSERT_EQ(of_others(bench).size(), 1U);
  EXPECT_EQ(of_others(bench)[0].first, sent);
  EXPECT_EQ(bench.heard().size(), 1U);
  EXPECT_FALSE(bench.garbled());
  bench.send("0123456789ABCDE\r");
  bench.run(100ms);
  EXPECT_EQ(of_others(bench).size(), 17U);
}

TEST(EchoFault, RepeatsARequestAfterItsEndAndTheGivenTime) {
  for (const VirtualTime delay : {5ms, 1ms}) {  // a character at 9600 baud takes 1.04 ms
    FaultBench bench;
    bench.add("echo " + time_text(delay));
    EXPECT_EQ(bench.ask("$05M"), "$05M");  // the line has no module 05
    EXPECT_GT(of_others(bench)[0].first, bench.recorder().bytes[4].end);
    EXPECT_LE(of_others(bench)[0].first, bench.recorder().bytes[4].end + delay + 1ms);
  }
}

TEST(EchoFault, TheLineIsUnsettledBeforeTheEchoAndSettledAfterIt) {
  FaultBench bench;
  bench.add("echo 5ms");
  EXPECT_FALSE(bench.line().unsettled());
  bench.send("$05M");
  bench.run(4ms);
  EXPECT_TRUE(bench.line().unsettled());
  bench.run(50ms);
  EXPECT_EQ(bench.heard(), "$05M");
  EXPECT_FALSE(bench.line().unsettled());
}

TEST(EchoFault, FollowsTheLinesRate) {
  FaultBench bench;
  bench.add("echo 5ms");
  bench.line().master().set_baud(19200);
  EXPECT_EQ(bench.ask("$05M"), "$05M");
}

TEST(ForeignTraffic, IsSentFromItsScheduledTimeAtTheLinesRate) {
  FaultBench bench;
  bench.add("foreign-traffic 0501000000083C48 at 1s");
  bench.run_until(2s);
  EXPECT_EQ(bench.heard(), "\x05\x01\0\0\0\x08\x3C\x48"s);
  const auto said = of_others(bench);
  ASSERT_EQ(said.size(), 8U);
  EXPECT_EQ(said[0].first, 1s);
  EXPECT_EQ(said[7].first - said[0].first, bench.line().master().takes(7));
}

TEST(ForeignTraffic, CollidesWithOtherTraffic) {
  FaultBench bench;
  bench.run_until(1s);
  bench.add("foreign-traffic 0000000000");
  EXPECT_NE(bench.ask("$01M"), kName);
}

TEST(ForeignTraffic, EndsWithin3sOfItsRemovalEvenIfItExceedsTheLinesCapacity) {
  FaultBench bench;
  const std::size_t fault = bench.add("foreign-traffic 00112233445566778899 every 1ms");
  bench.run(30s);
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.run(3s);
  EXPECT_EQ(bench.ask("$01M"), kName);
}

}  // namespace
}  // namespace ex9000::sim
