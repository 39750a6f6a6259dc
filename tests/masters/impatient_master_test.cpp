// Tests the simulator with masters that begin a request without the silence that a real line requires.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"

namespace ex9000::system {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes kOutputs1 = with_crc({0x01, 0x01, 0x00, 0x00, 0x00, 0x0D});
const Bytes kOutputs1Off = with_crc({0x01, 0x01, 0x02, 0x00, 0x00});
const Bytes kOutputs1First = with_crc({0x01, 0x01, 0x02, 0x01, 0x00});
const Bytes kInputs2 = with_crc({0x02, 0x02, 0x00, 0x00, 0x00, 0x08});
const Bytes kInputs2Off = with_crc({0x02, 0x02, 0x01, 0x00});
const Bytes kAllFirstOn = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});
const Bytes kHostOk1 = with_crc({0x01, 0x03, 0x30, 0x38, 0x00, 0x00});
const Bytes kHostOkAll = with_crc({0x00, 0x03, 0x30, 0x38, 0x00, 0x00});
const Bytes kAbsent = with_crc({0x63, 0x01, 0x00, 0x00, 0x00, 0x01});

Bytes operator+(Bytes first, const Bytes& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

class Line {
 public:
  explicit Line(const std::vector<std::string>& options) : simulator_(with_modules(options)) {}

  /// Sends the bytes in one piece. Waits for `answer` bytes and returns them.
  Bytes ask(const Bytes& bytes, std::size_t answer) {
    client_.send(bytes);
    return client_.receive(answer);
  }
  std::string ask(const std::string& command, std::size_t answer) {
    return text(ask(Bytes(command.begin(), command.end()), answer));
  }
  void send(const Bytes& bytes) { client_.send(bytes); }

 private:
  static std::vector<std::string> with_modules(std::vector<std::string> options) {
    options.insert(options.begin(), {"EX9042D-M@01", "EX9052D-M@02", "EX9042D@03", "--port", "tcp:0"});
    return options;
  }

  SimulatorProcess simulator_;
  SocketClient client_{simulator_.tcp_port()};
};

TEST(ImpatientMaster, OnAnInstantLineEachOfTwoFramesSentTogetherGetsAReply) {
  Line line({"--timing", "instant"});
  for (int round = 0; round < 10; ++round) {
    EXPECT_EQ(line.ask(kOutputs1 + kInputs2, 13), kOutputs1Off + kInputs2Off);
    EXPECT_EQ(line.ask(kOutputs1 + kOutputs1, 14), kOutputs1Off + kOutputs1Off);
  }
}

TEST(ImpatientMaster, OnAnInstantLineARequestMayImmediatelyFollowAnUnansweredRequest) {
  Line line({"--timing", "instant"});
  for (const Bytes& unanswered : {kHostOk1, kHostOkAll, kAbsent}) {
    for (int round = 0; round < 10; ++round) {
      EXPECT_EQ(line.ask(unanswered + kOutputs1, 7), kOutputs1Off);
      line.send(unanswered);
      EXPECT_EQ(line.ask(kInputs2, 6), kInputs2Off);
    }
  }
  EXPECT_EQ(line.ask(kAllFirstOn + kOutputs1, 7), kOutputs1First);
}

TEST(ImpatientMaster, AModbusRequestMayImmediatelyFollowAnAsciiReply) {
  for (const char* kind : {"paced", "instant"}) {
    Line line({"--timing", kind});
    for (int round = 0; round < 5; ++round) {
      EXPECT_EQ(line.ask("$03M\r", 9), "!039042D\r") << kind;
      EXPECT_EQ(line.ask(kInputs2, 6), kInputs2Off) << kind;
    }
  }
}

TEST(ImpatientMaster, ARequestToAnotherModuleMayImmediatelyFollowAReply) {
  for (const char* kind : {"paced", "instant"}) {
    Line line({"--timing", kind});
    for (int round = 0; round < 5; ++round) {
      EXPECT_EQ(line.ask(kOutputs1, 7), kOutputs1Off) << kind;
      EXPECT_EQ(line.ask(kInputs2, 6), kInputs2Off) << kind;
    }
  }
}

// At 1200 baud, the request takes 67 ms, T3.5 takes 32 ms and the reply takes 58 ms, so the reply ends
// at 157 ms. The first request to module 02 begins at 175 ms, less than T3.5 later. Module 02 also receives
// the reply, so it treats the reply and this request as one frame.
TEST(ImpatientMaster, ARequestLessThanT35AfterAReplyIsLostIfGapsAreStrict) {
  SimulatorProcess simulator({"EX9042D-M@01,baud=1200", "EX9052D-M@02,baud=1200", "--port", "tcp:0",
                              "--strict-gaps", "--speed", "step", "--control", "ctl"});
  ControlClient control(simulator.directory() + "/ctl");
  SocketClient client(simulator.tcp_port());
  client.send(kOutputs1);
  control.ok("advance 175ms after 8");
  EXPECT_EQ(client.receive(7), kOutputs1Off);
  client.send(kInputs2);
  control.ok("advance 10s after 8");
  client.send(kInputs2);
  control.ok("advance 10s after 8");
  EXPECT_EQ(client.receive(6), kInputs2Off);
  EXPECT_TRUE(client.hears_nothing_for(std::chrono::milliseconds(0)))
      << "expected no reply to the first request to module 02";
}

}  // namespace
}  // namespace ex9000::system
