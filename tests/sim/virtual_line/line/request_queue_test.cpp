// Tests the queue of requests that share a line.
#include "sim/virtual_line/line/request_queue.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {
namespace {

using Frame = std::vector<std::uint8_t>;
using std::chrono::microseconds;
using std::chrono::milliseconds;

const Frame kRead1 = with_crc({0x01, 0x01, 0x00, 0x00, 0x00, 0x0D});
const Frame kOff1 = with_crc({0x01, 0x01, 0x02, 0x00, 0x00});
const Frame kRead2 = with_crc({0x02, 0x02, 0x00, 0x00, 0x00, 0x08});
const Frame kToNobody = with_crc({0x09, 0x01, 0x00, 0x00, 0x00, 0x0D});

/// Records the start of each frame of the master, and the end of the last byte from other stations.
class MasterWatch : public WireObserver {
 public:
  std::vector<VirtualTime> began;
  VirtualTime last_byte_of_others{0};

  void byte(std::size_t station, std::uint8_t /*byte*/, SerialMode /*mode*/, bool /*collided*/,
            VirtualTime start, VirtualTime end) override {
    if (station != 0) {
      last_byte_of_others = end;
      in_frame_ = false;
    } else if (!in_frame_ || start > last_end_ + microseconds(2)) {
      began.push_back(start);
      in_frame_ = true;
    }
    last_end_ = end;
  }

 private:
  bool in_frame_ = false;
  VirtualTime last_end_{0};
};

class Queue : public testing::TestWithParam<bool> {
 protected:
  Queue() {
    line_.come_up();
    line_.wires().observe(watch_);
  }

  RequestQueue::Request request(const Frame& frame, const std::string& name, bool expects_reply = true) {
    RequestQueue::Request asked;
    asked.bytes = frame;
    asked.expects_reply = expects_reply;
    asked.done = [this, name](const RequestQueue::Reply& reply) {
      results_.emplace_back(name, reply.bytes);
      times_.push_back(now());
      last_ = reply;
    };
    asked.owner = owner_;
    return asked;
  }
  void ask(const Frame& frame, const std::string& name) { line_.requests().ask(request(frame, name)); }
  [[nodiscard]] VirtualTime now() { return line_.clock().virtual_now(); }
  void run(VirtualTime time) { line_.wires().run_for(time); }

  using Results = std::vector<std::pair<std::string, Frame>>;

  std::shared_ptr<int> owner_ = std::make_shared<int>();
  Results results_;
  std::vector<VirtualTime> times_;
  RequestQueue::Reply last_;
  MasterWatch watch_;
  Line line_{
      {parse_module_spec("EX9042D-M@01"), parse_module_spec("EX9052D-M@02"), parse_module_spec("EX9042D@03")},
      GetParam() ? kInstant : kPaced,
      [](std::uint8_t /*byte*/, ByteStatus /*status*/) {}};
};

TEST_P(Queue, ARequestBeginsOnlyAfterTheSilenceThatEndsThePreviousReply) {
  ask(kRead1, "a");
  ask(kRead2, "b");
  while (results_.empty()) {
    line_.wires().run_next();
  }
  const VirtualTime reply_ended = watch_.last_byte_of_others;
  run(milliseconds(500));
  ASSERT_EQ(watch_.began.size(), 2U);
  EXPECT_GE(watch_.began[1] - reply_ended, line_.rtu_silence());
}

TEST_P(Queue, AMissingReplyIsReportedAfterTheTimeoutAndTheNextRequestFollows) {
  ask(kToNobody, "nobody");
  ask(kRead1, "a");
  const VirtualTime asked = now();
  run(std::chrono::seconds(1));
  EXPECT_EQ(results_, (Results{{"nobody", {}}, {"a", kOff1}}));
  const VirtualTime waited = times_[0] - asked - line_.master().takes(kToNobody.size());
  EXPECT_GE(waited, RequestQueue::kReplyTimeout);
  EXPECT_LE(waited, RequestQueue::kReplyTimeout + line_.rtu_silence());
}

TEST_P(Queue, ABroadcastDelaysTheNextRequestByTheTurnaroundTime) {
  const Frame broadcast = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});
  line_.requests().ask(request(broadcast, "all", false));
  ask(kRead1, "a");
  run(std::chrono::seconds(1));
  EXPECT_EQ(results_, (Results{{"all", {}}, {"a", with_crc({0x01, 0x01, 0x02, 0x01, 0x00})}}));
  ASSERT_EQ(watch_.began.size(), 2U);
  EXPECT_GE(watch_.began[1] - watch_.began[0], RequestQueue::kTurnaround);
}

TEST_P(Queue, IfARequestChecksItsReplyADamagedReplyIsIgnoredOtherwiseItIsMarkedAsDamaged) {
  const auto with_reply_in_another_format = [this](RequestQueue::Request asked) {
    line_.requests().ask(std::move(asked));
    do {
      line_.wires().run_next();
    } while (line_.master().sending());
    line_.master().set_format(LineFormat::k8E1);
    run(std::chrono::seconds(1));
    line_.master().set_format(LineFormat::k8N1);
  };
  with_reply_in_another_format(request(kRead1, "raw"));
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_TRUE(last_.damaged);
  RequestQueue::Request checks = request(kRead1, "checks");
  checks.is_reply = [](Bytes /*frame*/) { return true; };
  with_reply_in_another_format(std::move(checks));
  EXPECT_EQ(results_.back(), (Results::value_type{"checks", {}}));
}

TEST_P(Queue, ANewRequestRemovesRequestsWhoseOwnersAreGone) {
  ask(kToNobody, "a");
  auto other = std::make_shared<int>();
  const std::weak_ptr<int> its_request = [&] {
    auto content = std::make_shared<int>();
    RequestQueue::Request asked = request(kRead2, "gone");
    asked.owner = other;
    asked.is_reply = [content](Bytes /*frame*/) { return true; };
    line_.requests().ask(std::move(asked));
    return std::weak_ptr<int>(content);
  }();
  other.reset();
  EXPECT_FALSE(its_request.expired());
  ask(kRead1, "b");
  EXPECT_TRUE(its_request.expired());
}

TEST_P(Queue, ARequestThatCannotBeSentInTimeIsNotSentLater) {
  const Frame commands(1000, '$');
  line_.master().set_baud(1200);
  line_.master().send(commands.data(), commands.size());  // takes 8.3 s on the paced line
  ask(kRead1, "late");
  run(std::chrono::seconds(1));
  ASSERT_EQ(results_.size(), 1U);
  const bool paced = !GetParam();
  if (paced) {
    run(std::chrono::seconds(10));
    EXPECT_EQ(watch_.began.size(), 1U);  // only `commands` has been sent, not the request
  }
}

TEST_P(Queue, ARequestWaitsForARequestOfAnotherProgramAndItsReply) {
  for (int i = 0; i < 3; ++i) {
    line_.master().send(kRead2.data(), kRead2.size());
    ask(kRead1, "a");
    run(milliseconds(500));
  }
  EXPECT_EQ(results_, (Results{{"a", kOff1}, {"a", kOff1}, {"a", kOff1}}));
}

TEST_P(Queue, IfAModuleLosesPowerDuringItsReplyTheNextFrameOfTheMasterIsASeparateFrame) {
  line_.master().send(kRead2.data(), kRead2.size());
  while (watch_.last_byte_of_others == VirtualTime(0)) {
    line_.wires().run_next();
  }
  line_.module(1).power(false);
  const VirtualTime off = now();
  line_.master().send(kRead1.data(), kRead1.size(), line_.spacing().after_others(kRead1[0]));
  run(milliseconds(200));
  EXPECT_GT(watch_.last_byte_of_others, off);  // the reply of the module at address 01
}

/// A station that sends one byte in each `period`. Its constructor sends the first byte.
class Babbler final : public Station {
 public:
  Babbler(Wires& wires, VirtualTime period) : wires_(wires), end_(wires.attach(*this)), period_(period) {
    run();
  }

  void run() override {
    end_.drive(true);
    end_.put({0x55, {9600, LineFormat::k8N1}});
    end_.run_at(wires_.clock().virtual_now() + period_);
  }

 private:
  Wires& wires_;
  WireEnd& end_;
  VirtualTime period_;
};

/// Tests of this suite run only on a paced line. On an instant line, the babbler would send hundreds of
/// thousands of bytes.
using PacedQueue = Queue;

TEST_P(PacedQueue, AStationThatNeverStopsSendingDoesNotBlockARequestForEver) {
  RequestQueue::Request checked = request(kToNobody, "checked");
  checked.is_reply = [](Bytes /*frame*/) { return true; };
  line_.requests().ask(std::move(checked));
  ask(kToNobody, "raw");
  run(milliseconds(20));  // the first request has been sent
  const Babbler babbler(line_.wires(), line_.rtu_silence() / 2);
  run(RequestQueue::kReplyTimeout + milliseconds(80));
  EXPECT_EQ(results_, (Results{{"checked", {}}}));
  run(2 * RequestQueue::kReplyTimeout + milliseconds(100));
  ASSERT_EQ(results_.size(), 2U);
  EXPECT_TRUE(last_.damaged);
  EXPECT_LE(last_.bytes.size(), 256U);
}

TEST_P(Queue, TheDelayOfAReplyEndsWithItsFirstByte) {
  ask(kRead1, "a");
  run(milliseconds(200));
  const VirtualTime whole = times_[0] - watch_.began[0];
  const VirtualTime rest =
      line_.master().takes(kRead1.size()) + line_.master().takes(kOff1.size() - 1) + line_.rtu_silence();
  EXPECT_NEAR(static_cast<double>(last_.delay.count()), static_cast<double>((whole - rest).count()), 3000);
}

INSTANTIATE_TEST_SUITE_P(Paced, PacedQueue, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Lines, Queue, testing::Bool(),
                         [](const auto& kind) { return kind.param ? "Instant" : "Paced"; });

}  // namespace
}  // namespace ex9000::sim
