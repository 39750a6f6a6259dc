// Tests lost replies, late replies, noise during replies, and a late driver, in virtual time.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/virtual_line/bus_faults/fault_bench.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

TEST(LostReply, IsNotSentAlthoughTheCommandIsExecuted) {
  FaultBench bench;
  bench.add("lost-reply");
  EXPECT_EQ(bench.ask("@010001"), "");
  EXPECT_EQ(bench.at(1).outputs(), 1);
  EXPECT_EQ(answers_of(bench, 1).size(), 0U);
}

TEST(LateReply, IsCompleteAndDelayedByTheGivenTime) {
  FaultBench punctual;
  EXPECT_EQ(punctual.ask("$01M"), kName);
  FaultBench bench;
  bench.add("late-reply 50ms");
  EXPECT_EQ(bench.ask("$01M", 100ms), kName);
  EXPECT_EQ(answers_of(bench, 1)[0], answers_of(punctual, 1)[0] + 50ms);
}

TEST(LateReply, MayComeAfterTheNextRequestAndBeforeItsReply) {
  FaultBench bench;
  bench.add("late-reply 50ms every 2nd reply");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M", 20ms), "");  // the master's timeout is too short
  EXPECT_EQ(bench.ask("$012", 1ms), "");   // the master sends another request
  bench.run(100ms);
  EXPECT_EQ(bench.heard(), kName + "\r!01400600\r");  // both replies, in the order of the requests
  EXPECT_FALSE(bench.garbled());
}

TEST(LateReply, KeepsTheOrderOfTheReplies) {
  FaultBench bench;
  bench.add("late-reply 200ms");
  bench.forget();
  for (const char* command : {"$01M\r", "$012\r", "@01\r", "$01F\r"}) {
    bench.send(command);
    bench.run(25ms);
  }
  bench.run(500ms);
  EXPECT_EQ(bench.heard(), kName + "\r!01400600\r>0000\r!01D01.00\r");
}

TEST(LateReply, IfItsFaultIsRemovedItIsSentImmediatelyAndTheNextReplyIsNotLate) {
  for (const bool all : {false, true}) {
    FaultBench bench;
    const std::size_t fault = bench.add("late-reply 1h");
    EXPECT_EQ(bench.ask("$01M"), "");
    if (all) {
      bench.faults().remove_all();
    } else {
      EXPECT_TRUE(bench.faults().remove(fault));
    }
    bench.run(50ms);
    EXPECT_EQ(bench.heard(), kName + "\r");
    EXPECT_EQ(bench.ask("$01M"), kName);
  }
}

TEST(LateReply, IsCompleteIfItsFaultIsRemovedWhileTheModuleReplies) {
  FaultBench bench;
  const std::size_t fault = bench.add("late-reply 1h");
  bench.forget();
  bench.send("$01M\r");
  bench.run(5ms);  // the UART has sent a part of the reply
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.run(50ms);
  EXPECT_EQ(bench.heard(), kName + "\r");
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(LateReply, IsSentIfTheFaultThatDelaysItIsRemovedAlthoughAnotherFaultRemains) {
  FaultBench bench;
  const std::size_t first = bench.add("late-reply 1h");
  bench.add("late-reply 1s");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_TRUE(bench.faults().remove(first));
  bench.run(50ms);
  EXPECT_EQ(bench.heard(), kName + "\r");
  EXPECT_EQ(bench.ask("$01M", 1100ms), kName);
}

TEST(LateReply, IsNotSentIfAFaultThatDoesNotDelayItIsRemoved) {
  for (const char* delays : {"late-reply 1h", "late-reply 1h every 2nd reply"}) {
    FaultBench bench;
    const std::size_t other = bench.add("late-reply 10ms every 3rd reply");
    bench.add(delays);
    for (int i = 0; i < 4; ++i) {
      bench.send("$01M\r");
      bench.run(50ms);
    }
    bench.forget();
    EXPECT_TRUE(bench.faults().remove(other));
    bench.run(50ms);
    EXPECT_EQ(bench.heard(), "") << delays;
  }
}

TEST(LateReply, IsNotSentIfTheFaultOfAnotherModuleIsRemoved) {
  FaultBench bench({"EX9042D@01", "EX9042D@02"});
  bench.add("late-reply 1h", 1);
  const std::size_t other = bench.add("late-reply 1h", 2);
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.ask("$022"), "");
  EXPECT_TRUE(bench.faults().remove(other));
  bench.run(50ms);
  EXPECT_EQ(bench.heard(), "!02400600\r");
}

TEST(LateReply, IsNotSentAfterTheSupplyHasFailed) {
  FaultBench bench;
  bench.add("late-reply 200ms");
  EXPECT_EQ(bench.ask("$01M"), "");
  bench.at(1).power(false);
  bench.at(1).power(true);
  bench.forget();
  bench.run(1s);
  EXPECT_EQ(bench.heard(), "");
}

TEST(NoiseWithEachReply, DamagesRepliesEvenIfTheModuleHasRepliedBeforeTheFirstFault) {
  FaultBench bench;
  ASSERT_EQ(bench.ask("$01M"), kName);
  bench.add("bit-errors 1 every reply");
  EXPECT_NE(bench.ask("$01M"), kName);
  EXPECT_TRUE(bench.garbled());
}

TEST(LateReply, NoiseDamagesTheLateReplyButNotTheNextRequest) {
  FaultBench bench;
  bench.add("late-reply 50ms every 2nd reply");
  bench.add("bit-errors 1 every 2nd reply");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M", 20ms), "");  // the master's timeout is too short
  bench.send("@010001\r");                 // the noise does not affect the next request
  bench.run(200ms);
  EXPECT_EQ(bench.at(1).outputs(), 1);
  EXPECT_EQ(bench.heard().find(kName), std::string::npos);
  EXPECT_TRUE(bench.garbled());
}

TEST(LateReply, ItsNoiseEndsAfterTheGivenDuration) {
  FaultBench bench;
  bench.add("late-reply 50ms every 2nd reply");
  bench.add("bit-errors 1 every 2nd reply for 20ms");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_NE(bench.ask("$01M", 100ms), kName);
  EXPECT_EQ(bench.faults().list().at(1).in_progress, 0U);
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(LostReply, ItsNoiseDoesNotDamageTheNextReply) {
  FaultBench bench;
  bench.add("lost-reply every 2nd reply");
  bench.add("bit-errors 1 every 2nd reply");
  bench.ask("$01M");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(LateDriver, IsDisabledImmediatelyIfItsFaultIsRemoved) {
  FaultBench bench;
  bench.add("late-driver 1h");
  EXPECT_EQ(bench.ask("$01M"), kName);
  bench.faults().remove_all();
  bench.run(1ms);
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_FALSE(bench.garbled());
}

TEST(LateDriver, ANewTimeCountsFromTheEndOfTheReply) {
  FaultBench bench;
  bench.at(1).release_driver_late(1h);
  EXPECT_EQ(bench.ask("$01M", 15ms), kName);
  bench.at(1).release_driver_late(40ms);
  bench.run(100ms);
  const VirtualTime held = bench.recorder().drivers.back().at - bench.recorder().bytes.back().end;
  EXPECT_GE(held, 40ms);
  EXPECT_LE(held, 40ms + 3us);
}

// wire.md section 6, module watchdog: a reply that does not end stops the feeds.
TEST(LateDriver, IsEndedByTheModuleWatchdogAfterAboutASecond) {
  FaultBench bench;
  bench.add("late-driver 1h");
  EXPECT_EQ(bench.ask("$01M"), kName);
  bench.run(900ms);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 0U);
  bench.run(1s);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
  bench.faults().remove_all();
  bench.run(100ms);
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(LateDriver, HoldsTheLineForTheGivenTimeAndBlocksRequestsDuringThisTime) {
  FaultBench bench;
  bench.add("late-driver 20ms");
  EXPECT_EQ(bench.ask("$01M", 15ms), kName);
  EXPECT_NE(bench.ask("$01M", 15ms), kName);  // the request begins within the 20 ms
  bench.run(100ms);
  EXPECT_EQ(bench.ask("$01M", 100ms), kName);
  const BusRecorder::Driver off = bench.recorder().drivers.back();
  EXPECT_EQ(off.station, 1U);
  EXPECT_GE(off.at - bench.recorder().bytes.back().end, 20ms);
  EXPECT_LE(off.at - bench.recorder().bytes.back().end, 20ms + 3us);
}

}  // namespace
}  // namespace ex9000::sim
