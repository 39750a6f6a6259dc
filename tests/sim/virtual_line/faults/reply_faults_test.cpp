// Tests lost, late and changed replies, and a late driver, in virtual time.
#include <gtest/gtest.h>

#include <string>

#include "sim/text/values.hpp"
#include "tests/sim/virtual_line/faults/fault_bench.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

/// Sends a Modbus frame and returns all bytes that the master receives within 50 ms, both in hex.
std::string reply_to(FaultBench& bench, const std::string& frame) {
  const std::vector<std::uint8_t> bytes = parse_hex_bytes(frame);
  bench.forget();
  bench.send({bytes.begin(), bytes.end()});
  bench.run(50ms);
  return hex_text({bench.heard().begin(), bench.heard().end()});
}

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

TEST(LateReply, IfTheFaultIsRemovedTheRepliesKeepTheTimeBetweenThem) {
  FaultBench punctual;
  FaultBench bench;
  const std::size_t fault = bench.add("late-reply 1h");
  for (FaultBench* each : {&punctual, &bench}) {
    each->ask("$01M", 40ms);
    each->ask("$012", 20ms);
  }
  EXPECT_TRUE(bench.faults().remove(fault));
  const VirtualTime removed = bench.now();
  bench.run(200ms);
  const std::vector<VirtualTime> late = answers_of(bench, 1);
  ASSERT_EQ(late.size(), 2U);
  EXPECT_EQ(late[0], removed);
  EXPECT_EQ(late[1] - late[0], answers_of(punctual, 1)[1] - answers_of(punctual, 1)[0]);
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

TEST(LateReply, TheNumberOfWaitingRepliesIsLimited) {
  FaultBench bench;
  bench.add("late-reply 1h");
  for (int i = 0; i < 30'000; ++i) {
    bench.send("$01M\r");
    bench.run(20ms);
  }
  bench.run(1h);
  const std::size_t replies = bench.heard().size() / (kName.size() + 1);
  EXPECT_GT(replies, 20'000U);
  EXPECT_LT(replies, 25'000U);
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
  bench.add("late-reply 1s");
  const std::size_t last = bench.add("late-reply 1h");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_TRUE(bench.faults().remove(last));
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

TEST(LateReply, IsNotSentAfterTheSupplyHasFailedAndStopsIfItFails) {
  FaultBench bench;
  bench.add("late-reply 200ms");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.ask("$01M", 150ms).substr(0, 2), "!0");  // the first reply has begun
  EXPECT_LT(bench.heard().size(), kName.size());
  bench.at(1).power(false);
  bench.run(10ms);  // receives the byte that is cut off
  bench.at(1).power(true);
  bench.forget();
  bench.run(1s);
  EXPECT_EQ(bench.heard(), "");
}

// MODBUS Application Protocol V1.1b3, section 7: the function code with bit 7 set, then the exception code.
TEST(ExceptionFault, ReplacesTheReplyAlthoughTheRequestIsExecuted) {
  FaultBench bench({"EX9042D-M"});
  bench.add("exception 06");
  EXPECT_EQ(reply_to(bench, "01050000FF008C3A"), "018506C292");
  EXPECT_EQ(bench.at(1).outputs(), 1);
  EXPECT_LE(bench.recorder().drivers.back().at - bench.recorder().bytes.back().end, 3us);
  bench.faults().remove_all();
  EXPECT_EQ(reply_to(bench, "01050000FF008C3A"), "01050000FF008C3A");
}

TEST(ExceptionFault, ReplacesTheCodeOfAnException) {
  FaultBench bench({"EX9042D-M"});
  ASSERT_EQ(reply_to(bench, "010502FFFF00BDB2"), "018502C351");  // the module has no such address
  bench.add("exception 06");
  EXPECT_EQ(reply_to(bench, "010502FFFF00BDB2"), "018506C292");
}

TEST(ExceptionFault, ReplacesEveryNthReply) {
  FaultBench bench({"EX9052D-M"});
  bench.add("exception 06 every 2nd reply");
  for (const char* reply : {"01020100A188", "018206C0A2", "01020100A188"}) {
    EXPECT_EQ(reply_to(bench, "01020000000879CC"), reply);
  }
}

TEST(ExceptionFault, RejectsACommandInAsciiAndDoesNotAffectBroadcasts) {
  FaultBench bench({"EX9042D-M", "EX9042D@02", "EX9042D@03,checksum=on"});
  bench.add("exception 06");
  EXPECT_EQ(reply_to(bench, "00050000FF008DEB"), "");
  EXPECT_EQ(bench.at(1).outputs(), 1);
  EXPECT_EQ(bench.ask("$02M"), "?02");
  EXPECT_EQ(bench.ask("$03MD4"), "?03A2");
}

TEST(WrongUnit, ReplacesTheAddressOfAModbusReply) {
  FaultBench bench({"EX9042D-M"});
  bench.add("wrong-unit 7F");
  EXPECT_EQ(reply_to(bench, "0101000000043DC9"), "7F01010049A0");
  bench.add("exception 06");
  EXPECT_EQ(reply_to(bench, "01050000FF008C3A"), "7F8506A28A");
  EXPECT_EQ(bench.at(1).outputs(), 1);
}

TEST(WrongUnit, ReplacesTheAddressOfAnAsciiReplyIfThereIsOne) {
  FaultBench bench;
  bench.add("wrong-unit 7F");
  EXPECT_EQ(bench.ask("$01M"), "!7F9042D");
  EXPECT_EQ(bench.ask("$01Q"), "?7F");
  EXPECT_EQ(bench.ask("@01"), ">0000");
  EXPECT_EQ(bench.ask("@01Z"), "?");
}

TEST(WrongUnit, KeepsTheChecksumRight) {
  FaultBench bench({"EX9042D,checksum=on"});
  bench.add("wrong-unit 7F");
  EXPECT_EQ(bench.ask("$01MD2"), "!7F9042DB1");
  EXPECT_EQ(bench.ask("@01A1"), ">0000FE");
  EXPECT_EQ(bench.ask("@01ZFB"), "?3F");
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
  const WiresRecorder::Driver off = bench.recorder().drivers.back();
  EXPECT_EQ(off.station, 1U);
  EXPECT_GE(off.at - bench.recorder().bytes.back().end, 20ms);
  EXPECT_LE(off.at - bench.recorder().bytes.back().end, 20ms + 3us);
}

}  // namespace
}  // namespace ex9000::sim
