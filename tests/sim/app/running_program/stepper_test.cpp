// Tests the command `advance`: the events that it waits for, the time that it lets pass, and its replies.
#include "sim/app/running_program/stepper.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/module_notation.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;
using FrameOfBytes = std::vector<std::uint8_t>;

/// A port in memory. As in the kernel, the bytes that a master writes wait until the simulator reads them.
class FakePort final : public Port {
 public:
  [[nodiscard]] PortSummary summary() const override { return {}; }
  void start(Arrivals& arrivals) override { arrivals_ = &arrivals; }
  void resume() override {
    EXPECT_TRUE(paused_ || receiving_) << "resume was called, but the port does not wait";
    paused_ = false;
  }
  void read_waiting() override {
    if (!written_.empty() && !paused_) {
      const std::vector<std::uint8_t> bytes = std::exchange(written_, {});
      receiving_ = true;
      paused_ = !arrivals_->bytes(*this, {bytes.data(), bytes.size()}, {}, nullptr);
      receiving_ = false;
    }
  }
  std::size_t send(const std::vector<std::uint8_t>& bytes) override {
    const std::size_t taken = std::min(bytes.size(), room_ - std::min(room_, read_.size()));
    read_.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    return bytes.size() - taken;
  }
  [[nodiscard]] std::optional<std::uint32_t> baud() const override { return rate_; }

  /// Writes bytes as a master. The simulator is not notified yet.
  void write(const std::vector<std::uint8_t>& bytes) {
    written_.insert(written_.end(), bytes.begin(), bytes.end());
  }
  void write(const std::string& text) { write(std::vector<std::uint8_t>(text.begin(), text.end())); }
  /// Notifies the simulator of the written bytes.
  void tell() { read_waiting(); }
  std::string take_read() { return std::exchange(read_, {}); }

  std::size_t room_ = 4096;
  std::optional<std::uint32_t> rate_;

 private:
  Arrivals* arrivals_ = nullptr;
  bool paused_ = false;
  bool receiving_ = false;
  std::vector<std::uint8_t> written_;
  std::string read_;
};

/// A line with a port, in stepped time.
struct StillLine {
  explicit StillLine(const std::vector<std::string>& modules) {
    std::vector<ModuleSpec> specs;
    for (const std::string& module : modules) {
      specs.push_back(parse_module_spec(module));
    }
    line = std::make_unique<Line>(specs, kPaced, [this](std::uint8_t byte, ByteStatus /*status*/) {
      if (connected) {
        connected->hear(byte);
      }
    });
    line->come_up();
    auto its_port = std::make_unique<FakePort>();
    port = its_port.get();
    ports.push_back(std::move(its_port));
    connected = std::make_unique<LinePorts>(*line, ports,
                                            [this](const std::string& text) { notices.push_back(text); });
    stepped = std::make_unique<SteppedLine>(*line, *connected, nullptr);
  }

  std::unique_ptr<Line> line;
  LinePorts::All ports;
  FakePort* port = nullptr;
  std::unique_ptr<LinePorts> connected;
  std::unique_ptr<SteppedLine> stepped;
  std::vector<std::string> notices;
};

class StepperTest : public testing::Test {
 protected:
  StepperTest() { start_stepped(line_); }

  void start_stepped(StillLine& line) {
    line.stepped->start([this] {
      if (stepper_) {
        stepper_->arrived();
      }
    });
  }
  void begin(VirtualTime end = kNever) {
    stepper_.emplace(std::vector<SteppedLine*>{line_.stepped.get(), other_.stepped.get()}, end,
                     [this] { return asked_to_end_; });
  }
  void SetUp() override {
    start_stepped(other_);
    begin();
  }

  std::string advance(const std::string& rest) {
    answers_.clear();
    stepper_->advance("advance " + rest, [this](const Control::Reply& reply) {
      answers_.push_back(reply.text);
      quits_ = reply.quit;
    });
    return answers_.empty() ? "" : answers_.back();
  }

  StillLine line_{{"EX9042D@01", "EX9042D-M@02"}};
  StillLine other_{{"EX9052D@01"}};
  std::optional<Stepper> stepper_;
  std::vector<std::string> answers_;
  bool quits_ = false;
  bool asked_to_end_ = false;
};

TEST_F(StepperTest, AdvancesTheTimeOfAllLinesAndReportsItInSeconds) {
  EXPECT_EQ(advance("250ms"), "ok 0.35");  // the modules have started up in the first 0.1 s
  EXPECT_EQ(line_.stepped->now(), milliseconds(350));
  EXPECT_EQ(other_.stepped->now(), milliseconds(350));
  EXPECT_EQ(advance("0s"), "ok 0.35");
  EXPECT_EQ(advance("104.166us"), "ok 0.350104166");
  EXPECT_EQ(advance("24h"), "ok 86400.350104166");
}

TEST_F(StepperTest, TimeStopsWhenTheProgramIsAskedToEnd) {
  asked_to_end_ = true;
  EXPECT_EQ(advance("24h"), "error: the program was asked to end while time passed");
  EXPECT_LT(line_.stepped->now(), std::chrono::hours(1));
  EXPECT_FALSE(quits_);
}

TEST_F(StepperTest, WithoutAnAdvanceNoTimePassesAndNoReplyArrives) {
  line_.port->write("$01M\r");
  line_.port->tell();
  EXPECT_EQ(line_.stepped->now(), milliseconds(100));
  EXPECT_EQ(line_.port->take_read(), "");
}

TEST_F(StepperTest, AnAdvanceThatEndsDuringAReplyDeliversTheBytesSoFar) {
  line_.port->write("$01M\r");
  advance("11ms");
  const std::string begun = line_.port->take_read();
  EXPECT_FALSE(begun.empty());
  advance("20ms");
  EXPECT_EQ(begun + line_.port->take_read(), "!019042D\r");
}

TEST_F(StepperTest, WaitsForTheGivenNumberOfBytes) {
  EXPECT_EQ(advance("50ms after 5"), "");
  EXPECT_EQ(line_.stepped->now(), milliseconds(100));
  line_.port->write("$01");
  line_.port->tell();
  EXPECT_TRUE(answers_.empty());
  line_.port->write("M\r");
  line_.port->tell();
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0], "ok 0.15");
  EXPECT_EQ(line_.port->take_read(), "!019042D\r");
}

TEST_F(StepperTest, CountsTheNewBytesOfAllLines) {
  line_.port->write("$01M\r");
  EXPECT_EQ(advance("50ms after 5"), "ok 0.15");
  EXPECT_EQ(advance("50ms after 10"), "");  // the first five bytes do not count again
  line_.port->write("$01M\r");
  line_.port->tell();
  EXPECT_TRUE(answers_.empty());
  other_.port->write("$01M\r");
  other_.port->tell();
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(other_.port->take_read(), "!019052\r");
}

TEST_F(StepperTest, BytesThatArriveBeforeTheSameAdvanceFollowEachOtherWithoutAGap) {
  const std::vector<std::uint8_t> request = with_crc({2, 1, 0, 0, 0, 13});
  line_.port->write(FrameOfBytes(request.begin(), request.begin() + 3));
  line_.port->tell();
  line_.port->write(FrameOfBytes(request.begin() + 3, request.end()));
  EXPECT_EQ(advance("50ms after 8"), "ok 0.15");
  EXPECT_EQ(line_.port->take_read().size(), 7U);
}

TEST_F(StepperTest, TheTimeOfAnAdvanceSeparatesBytesThatArriveBeforeAndAfterIt) {
  const std::vector<std::uint8_t> request = with_crc({2, 1, 0, 0, 0, 13});
  line_.port->write(FrameOfBytes(request.begin(), request.begin() + 3));
  advance("20ms after 3");
  line_.port->write(FrameOfBytes(request.begin() + 3, request.end()));
  advance("50ms after 5");
  EXPECT_EQ(line_.port->take_read(), "");  // a silence of more than 3.5 characters has split the frame
}

TEST_F(StepperTest, QuietEndsWhenTheReplyIsComplete) {
  other_.port->write("$01M\r");
  const std::string answer = advance("10s after 5 quiet");
  EXPECT_EQ(other_.port->take_read(), "!019052\r");
  // The advance takes 5 + 1 + 8 characters (request, turn-around, reply) of 1.0417 ms, and the time to switch
  // the driver. No module of this line uses Modbus, so `quiet` does not wait for the silence after a Modbus
  // frame.
  const double took = std::stod(answer.substr(3)) - 0.1;
  EXPECT_GT(took, 0.0145);
  EXPECT_LT(took, 0.0147);
}

TEST_F(StepperTest, QuietMayComeBeforeAfter) {
  EXPECT_EQ(advance("10s quiet after 5"), "");
  other_.port->write("$01M\r");
  other_.port->tell();
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(other_.port->take_read(), "!019052\r");
  EXPECT_LT(std::stod(answers_[0].substr(3)) - 0.1, 0.0147);  // not 10 s
}

TEST_F(StepperTest, QuietWaitsForTheSilenceThatEndsAModbusFrame) {
  line_.port->write(with_crc({7, 1, 0, 0, 0, 13}));  // no module has this address
  const double took = std::stod(advance("10s after 8 quiet").substr(3)) - 0.1;
  EXPECT_GT(took, 8 * 10 / 9600.0 + 3.5 * 11 / 9600.0 - 1e-6);
  EXPECT_LT(took, 0.015);
  EXPECT_EQ(line_.port->take_read(), "");
}

TEST_F(StepperTest, QuietWaitsForAModuleThatIsStarting) {
  line_.line->module(0).power(false);
  line_.line->module(0).power(true);
  EXPECT_TRUE(line_.stepped->pending());
  advance("10s quiet");
  EXPECT_TRUE(line_.line->module(0).module().listening());
}

TEST_F(StepperTest, QuietDoesNotAdvanceIfNothingIsPending) {
  EXPECT_EQ(advance("10s quiet"), "ok 0.1");
  EXPECT_EQ(advance("10s"), "ok 10.1");
}

TEST_F(StepperTest, QuietDoesNotWaitForAHostWatchdog) {
  line_.port->write("~013101\r");  // enables the host watchdog, timeout 0.1 s
  advance("10s after 8 quiet");
  EXPECT_EQ(line_.port->take_read(), "!01\r");
  line_.port->write("~010\r");
  advance("10s quiet");
  EXPECT_EQ(line_.port->take_read(), "!0180\r");
  advance("150ms");
  line_.port->write("~010\r");
  advance("10s quiet");
  EXPECT_EQ(line_.port->take_read(), "!0184\r");
}

TEST_F(StepperTest, TheLineTakesTheBaudRateOfAPortBeforeItSendsTheBytesOfThePort) {
  line_.port->rate_ = 19200;
  line_.port->write("$01M\r");
  advance("50ms");
  EXPECT_EQ(line_.port->take_read(), "");
  EXPECT_EQ(line_.notices.size(), 2U);  // both modules listen at 9600 baud
  line_.port->rate_ = 9600;
  line_.port->write("\r$01M\r");
  advance("50ms");
  EXPECT_EQ(line_.port->take_read(), "!019042D\r");
}

TEST_F(StepperTest, BytesForAFullPortAreDroppedAndReported) {
  line_.port->room_ = 4;
  line_.port->write("$01M\r");
  EXPECT_EQ(advance("50ms"), "ok 0.15");
  EXPECT_EQ(line_.port->take_read(), "!019");
  ASSERT_EQ(line_.notices.size(), 1U);
  EXPECT_EQ(line_.notices[0].rfind("a port is full: 5 bytes are dropped", 0), 0U) << line_.notices[0];
  EXPECT_EQ(line_.connected->sent(), 9U);
}

TEST_F(StepperTest, AFullPortIsReportedOnceUntilItHasRoomAgain) {
  const auto ask = [this] {
    line_.port->write("$01M\r");
    advance("50ms");
  };
  line_.port->room_ = 9;
  ask();
  ask();
  ask();
  EXPECT_EQ(line_.notices.size(), 1U);
  line_.port->take_read();
  ask();
  EXPECT_EQ(line_.notices.size(), 1U);
  ask();
  EXPECT_EQ(line_.notices.size(), 2U);
}

TEST_F(StepperTest, ALaterAdvanceReplacesAWaitingOne) {
  std::string first;
  stepper_->advance("advance 1s after 5", [&](const Control::Reply& reply) { first = reply.text; });
  EXPECT_EQ(first, "");
  EXPECT_EQ(advance("1s"), "ok 1.1");
  EXPECT_EQ(first.rfind("error: ", 0), 0U) << first;
}

TEST_F(StepperTest, TheProgramEndsAtItsEndTime) {
  begin(milliseconds(600));
  EXPECT_EQ(advance("499ms"), "ok 0.599");
  EXPECT_FALSE(quits_);
  EXPECT_EQ(advance("1h"), "ok 0.6");
  EXPECT_TRUE(quits_);
}

TEST_F(StepperTest, BytesBeyondTheMaximumAreNotReadBeforeAnAdvance) {
  const std::vector<std::uint8_t> zeros(SteppedLine::kMostBytes, 0);
  line_.port->write(zeros);
  line_.port->tell();
  line_.port->write("$01M\r");
  line_.port->tell();
  EXPECT_EQ(line_.stepped->waiting(), zeros.size());
  advance("0s");
  EXPECT_EQ(line_.stepped->waiting(), 0U);
  line_.port->tell();
  EXPECT_EQ(line_.stepped->waiting(), 5U);
}

TEST_F(StepperTest, AnInvalidAdvanceIsRefusedAndDoesNotAdvance) {
  for (const char* wrong :
       {"", "soon", "1", "-1s", "1s after", "1s after x", "1s after -1", "1s after 65537", "1s quietly",
        "1s quiet quiet", "1s after 5 quiet now", "1s quiet after", "1s after 5 after 5", "1s 5"}) {
    const std::string answer = advance(wrong);
    EXPECT_EQ(answer.rfind("error: ", 0), 0U) << wrong << ": " << answer;
    EXPECT_EQ(line_.stepped->now(), milliseconds(100));
  }
}

TEST_F(StepperTest, WaitsForUpTo65536Bytes) {
  EXPECT_EQ(advance("1s after 65536"), "");
  line_.port->write(std::vector<std::uint8_t>(65536, 0));
  line_.port->tell();
  EXPECT_EQ(answers_, std::vector<std::string>{"ok 1.1"});
}

TEST(Stepper, RecognizesTheAdvanceCommand) {
  EXPECT_TRUE(Stepper::is_advance("advance 1s"));
  EXPECT_TRUE(Stepper::is_advance("advance"));
  EXPECT_FALSE(Stepper::is_advance("advanced 1s"));
  EXPECT_FALSE(Stepper::is_advance("1 power on"));
  EXPECT_FALSE(Stepper::is_advance(""));
}

}  // namespace
}  // namespace ex9000::sim
