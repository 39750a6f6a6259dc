// Tests ModuleWire, which connects a module to the wires. The tests use no module.
#include "sim/virtual_line/wires/module_wire.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;
using Happened = std::vector<std::string>;

/// Records each event with its time in milliseconds, and each byte when its reply begins.
struct WireLog final : WireEnd {
  explicit WireLog(const VirtualClock& its_clock) : clock(its_clock) {}

  void drive(bool on) override { note(on ? "on" : "off"); }
  void send() override {
    while (const auto byte = sender->next_byte()) {
      put(*byte);
    }
  }
  void put(Character sent) override {
    note(std::string(1, static_cast<char>(sent.byte)) + " " + std::to_string(sent.mode.baud));
  }
  void listen(hal::SerialMode /*mode*/) override {}
  void run_at(VirtualTime /*when*/) override {}
  void hear_alone() override {}
  [[nodiscard]] VirtualTime takes(std::size_t bytes, hal::SerialMode mode) const override {
    return bytes * VirtualTime(10'000'000'000) / mode.baud;
  }
  void note(const std::string& what) {
    happened.push_back(std::to_string(clock.virtual_now() / 1ms) + " " + what);
  }

  const VirtualClock& clock;
  ModuleWire* sender = nullptr;
  Happened happened;
};

/// `reply` simulates a UART that sends a reply of one byte. A reply takes one millisecond.
class ModuleWireTest : public testing::Test {
 protected:
  ModuleWireTest() { wires.sender = &wire; }

  void put(char byte) {
    const auto sent = static_cast<std::uint8_t>(byte);
    wire.put({&sent, 1}, {9600});
  }
  void run_until(VirtualTime time) {
    while (wire.next() <= time) {
      clock.set(std::max(wire.next(), clock.virtual_now()));
      wire.run();
    }
    clock.set(time);
  }
  void begin_reply(char byte) {
    const auto sent = static_cast<std::uint8_t>(byte);
    wire.replaced({&sent, 1});
    wire.drive(true);
  }
  void reply(VirtualTime at, char byte) {
    run_until(at);
    begin_reply(byte);
    put(byte);
    run_until(at + 1ms);
    wire.drive(false);
  }
  void watch() {
    wire.watch(
        [this](Reply& reply) {
          reply.lost = lost;
          reply.late_by = late_by;
          reply.delayed_by = kFault;
        },
        [this] { ++ended; });
  }

  VirtualClock clock;
  WireLog wires{clock};
  ModuleWire wire{clock, wires};
  static constexpr std::size_t kFault = 1;
  bool lost = false;
  VirtualTime late_by{0};
  int ended = 0;
};

TEST_F(ModuleWireTest, AReplyKeepsItsForcedRateToTheEnd) {
  wire.force_rate(1200);
  run_until(5ms);
  wire.drive(true);
  put('a');
  wire.force_rate(0);
  put('b');
  EXPECT_EQ(wire.takes(2, {9600}), wires.takes(2, {1200}));
  wire.drive(false);
  wire.drive(true);
  put('c');
  EXPECT_EQ(wires.happened, (Happened{"5 on", "5 a 1200", "5 b 1200", "5 off", "5 on", "5 c 9600"}));
}

TEST_F(ModuleWireTest, IfTheDelaysEndTheFirstReplyIsSentImmediatelyAndTheTimeBetweenRepliesStaysTheSame) {
  watch();
  late_by = 1h;
  reply(5ms, 'a');
  reply(10ms, 'b');
  run_until(20ms);
  wire.end_delays(kFault);
  late_by = 0ms;
  run_until(30ms);
  EXPECT_EQ(wires.happened, (Happened{"20 on", "20 a 9600", "21 off", "25 on", "25 b 9600", "26 off"}));
  reply(40ms, 'c');
  EXPECT_EQ(wires.happened.size(), 9U);
}

TEST_F(ModuleWireTest, IfTheDelayEndsAtTheStartOfAReplyTheReplyIsNotLate) {
  watch();
  late_by = 1h;
  run_until(5ms);
  begin_reply('a');
  wire.end_delays(kFault);
  run_until(5ms);
  put('a');
  run_until(6ms);
  wire.drive(false);
  EXPECT_FALSE(wire.sends_late());
  EXPECT_EQ(wires.happened, (Happened{"5 on", "5 a 9600", "6 off"}));
}

TEST_F(ModuleWireTest, LimitsTheNumberOfStoredLateReplies) {
  watch();
  late_by = 1h;
  for (int i = 0; i < 30'000; ++i) {
    reply(5ms, 'a');
  }
  wire.end_delays(kFault);
  run_until(2h);
  EXPECT_LT(wires.happened.size(), 66'000U);
  EXPECT_GT(wires.happened.size(), 65'000U);
}

TEST_F(ModuleWireTest, ForwardsAReplyImmediatelyWithoutAWatcher) {
  reply(5ms, 'a');
  EXPECT_EQ(wires.happened, (Happened{"5 on", "5 a 9600", "6 off"}));
  EXPECT_EQ(wire.next(), kNever);
}

TEST_F(ModuleWireTest, ReportsTheEndOfAReply) {
  watch();
  reply(5ms, 'a');
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(wires.happened, (Happened{"5 on", "5 a 9600", "6 off"}));
}

TEST_F(ModuleWireTest, ALostReplyDoesNotEnableTheDriver) {
  watch();
  lost = true;
  reply(5ms, 'a');
  EXPECT_EQ(wires.happened, Happened());
  EXPECT_EQ(ended, 1);
  lost = false;
  reply(10ms, 'b');
  EXPECT_EQ(wires.happened, (Happened{"10 on", "10 b 9600", "11 off"}));
}

TEST_F(ModuleWireTest, ALateReplyIsSentUnchangedAfterTheUartHasFinished) {
  watch();
  late_by = 50ms;
  reply(5ms, 'a');
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(wires.happened, Happened());
  EXPECT_FALSE(wire.sends_late());
  run_until(55ms);
  EXPECT_TRUE(wire.sends_late());
  run_until(60ms);
  EXPECT_FALSE(wire.sends_late());
  EXPECT_EQ(wires.happened, (Happened{"55 on", "55 a 9600", "56 off"}));
}

TEST_F(ModuleWireTest, AReplyThatFollowsALateReplyIsSentAfterTheLateReply) {
  watch();
  late_by = 50ms;
  reply(5ms, 'a');
  late_by = 0ms;
  reply(10ms, 'b');
  run_until(100ms);
  EXPECT_EQ(wires.happened, (Happened{"55 on", "55 a 9600", "56 off", "56 on", "56 b 9600", "57 off"}));
}

TEST_F(ModuleWireTest, AReplyThatBeginsDuringALateReplyIsSentAfterAllLateReplies) {
  watch();
  late_by = 4ms;
  reply(5ms, 'a');
  reply(7ms, 'b');
  late_by = 0ms;
  reply(9ms, 'c');
  run_until(100ms);
  EXPECT_EQ(wires.happened, (Happened{"9 on", "9 a 9600", "10 off", "11 on", "11 b 9600", "12 off", "12 on",
                                      "12 c 9600", "13 off"}));
}

TEST_F(ModuleWireTest, AbortStopsALateReplyAndDropsAWaitingOne) {
  watch();
  late_by = 50ms;
  reply(5ms, 'a');
  run_until(55ms);
  wire.abort();
  EXPECT_EQ(wires.happened, (Happened{"55 on", "55 a 9600", "55 off"}));
  EXPECT_EQ(wire.next(), kNever);
  EXPECT_FALSE(wire.sends_late());
  reply(60ms, 'b');
  wire.abort();  // before the reply begins on the wires
  run_until(200ms);
  EXPECT_EQ(wires.happened.size(), 3U);
}

TEST_F(ModuleWireTest, AForcedRateAppliesToAByteAndToDurations) {
  wire.force_rate(1200);
  reply(5ms, 'a');
  EXPECT_EQ(wires.happened[1], "5 a 1200");
  EXPECT_EQ(wire.takes(3, {9600}), wires.takes(3, {1200}));
  EXPECT_EQ(wire.forced({9600, LineFormat::k8E1}), (hal::SerialMode{1200, LineFormat::k8E1}));
  EXPECT_EQ(wire.forced({}), hal::SerialMode{});  // a UART that is off stays off
  wire.force_rate(0);
  EXPECT_EQ(wire.forced({9600}), hal::SerialMode{9600});
  EXPECT_EQ(wire.takes(3, {9600}), wires.takes(3, {9600}));
}

}  // namespace
}  // namespace ex9000::sim
