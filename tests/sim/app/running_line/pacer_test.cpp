// Tests how long the pacer delays a frame of the master. Virtual time passes so slowly that the delays of a
// busy host are short in virtual time. All expected times are lower bounds, in virtual time.
#include "sim/app/running_line/pacer.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "tests/sim/virtual_line/wires/wires_recorder.hpp"

namespace ex9000::sim {
namespace {

using FrameBytes = std::vector<std::uint8_t>;

const FrameBytes kInputs2 = with_crc({0x02, 0x02, 0x00, 0x00, 0x00, 0x08});
const FrameBytes kAllFirstOn = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});

/// A port at which the test can deliver bytes immediately. Discards the bytes from the line.
class ImmediatePort final : public Port {
 public:
  [[nodiscard]] PortSummary summary() const override { return {}; }
  void start(Arrivals& arrivals) override { arrivals_ = &arrivals; }
  void resume() override {}
  std::size_t send(const std::vector<std::uint8_t>& /*bytes*/) override { return 0; }

  bool deliver(const FrameBytes& bytes) {
    return arrivals_->bytes(*this, {bytes.data(), bytes.size()}, {}, nullptr);
  }
  /// A master connects.
  void connect() { let_line_go(*arrivals_); }

 private:
  Arrivals* arrivals_ = nullptr;
};

/// Virtual time passes at 0.05 times the speed of the wall clock. At 115200 baud, T3.5 is 1.75 ms of virtual
/// time, which takes 35 ms on the wall clock.
constexpr Pace kSlow{VirtualTime(0), VirtualTime(0), true, 0.05};

class PacedLine : public testing::Test {
 protected:
  explicit PacedLine(bool holds = false) {
    auto port = std::make_unique<ImmediatePort>();
    port_ = port.get();
    ports_.push_back(std::move(port));
    pacer_.emplace(io_, line_, connected_, nullptr, kSlow, [](const std::string& /*text*/) {});
    line_.wires().observe(recorder_);
    line_.come_up();
    line_.master().set_baud(115200);
    recorder_.clear();
    if (holds) {
      port_->hold_line();
    }
    pacer_->start([this] { begun_ = true; });
  }

  /// Runs until nothing is pending: see Line::pending.
  void rest() {
    while (line_.pending()) {
      ASSERT_GT(io_.run_one(), 0U);
    }
  }
  void send(const FrameBytes& bytes) { ASSERT_TRUE(port_->deliver(bytes)); }
  /// Sends a request and runs until a reply of `answer` characters has ended.
  void ask(const FrameBytes& bytes, std::size_t answer) {
    recorder_.clear();
    send(bytes);
    while (recorder_.bytes.size() < bytes.size() + answer) {
      ASSERT_GT(io_.run_one(), 0U);
    }
  }
  /// Returns the time without a byte before the last frame on the line. This frame is from the master and has
  /// `characters` characters.
  [[nodiscard]] VirtualTime silence_before_last(std::size_t characters) const {
    const auto& bytes = recorder_.bytes;
    const std::size_t first = bytes.size() - characters;
    return bytes.at(first).start - bytes.at(first - 1).end;
  }
  bool first_are_on() {
    return (line_.module(0).outputs() & 1U) != 0 && (line_.module(3).outputs() & 1U) != 0;
  }

  ImmediatePort* port_ = nullptr;
  bool begun_ = false;
  boost::asio::io_context io_;
  LinePorts::All ports_;
  Line line_{{parse_module_spec("EX9042D-M@01,baud=115200"), parse_module_spec("EX9052D-M@02,baud=115200"),
              parse_module_spec("EX9042D@03,baud=115200"), parse_module_spec("EX9043D-M@04,baud=115200")},
             kPaced,
             [this](std::uint8_t byte, ByteStatus /*status*/) { connected_.hear(byte); }};
  LinePorts connected_{line_, ports_, [](const std::string& /*text*/) {}};
  WiresRecorder recorder_;
  std::optional<Pacer> pacer_;
};

class HeldLine : public PacedLine {
 protected:
  HeldLine() : PacedLine(true) {}
};

TEST_F(HeldLine, LineTimeBeginsWhenAMasterHasConnected) {
  const VirtualTime up = pacer_->present();
  EXPECT_FALSE(begun_);
  io_.poll();
  io_.restart();
  EXPECT_EQ(pacer_->present(), up);
  port_->connect();
  EXPECT_TRUE(begun_);
  ask({'$', '0', '3', 'M', '\r'}, 9);
  EXPECT_GT(pacer_->present(), up);
}

const FrameBytes kName3{'$', '0', '3', 'M', '\r'};

TEST_F(PacedLine, DelaysABroadcastAfterAnAsciiReplyUntilTheBroadcastIsASeparateModbusFrame) {
  ask(kName3, 9);
  send(kAllFirstOn);
  rest();
  EXPECT_GE(silence_before_last(kAllFirstOn.size()).count(), line_.rtu_separate().count());
  EXPECT_TRUE(first_are_on());
}

TEST_F(PacedLine, AModbusRequestImmediatelyAfterAnAsciiReplyGetsItsReply) {
  ask(kName3, 9);
  ask(kInputs2, 6);
  EXPECT_EQ(recorder_.sent_by(2), with_crc({0x02, 0x02, 0x01, 0x00}));
}

TEST_F(PacedLine, DelaysABroadcastAfterAModbusReplyUntilT35HasPassed) {
  ask(kInputs2, 6);
  send(kAllFirstOn);
  rest();
  EXPECT_GE(silence_before_last(kAllFirstOn.size()).count(), line_.rtu_silence().count());
  EXPECT_TRUE(first_are_on());
}

TEST_F(PacedLine, DelaysABroadcastAfterForeignTrafficUntilTheBroadcastIsASeparateModbusFrame) {
  pacer_->now([this] { line_.faults().add(parse_fault("foreign-traffic 2430394D0D")); });
  while (recorder_.bytes.size() < kName3.size()) {
    ASSERT_GT(io_.run_one(), 0U);
  }
  ASSERT_GT(recorder_.bytes.back().station, line_.size());
  send(kAllFirstOn);
  rest();
  EXPECT_GE(silence_before_last(kAllFirstOn.size()).count(), line_.rtu_separate().count());
  EXPECT_TRUE(first_are_on());
}

}  // namespace
}  // namespace ex9000::sim
