// Tests a line on which bytes take almost no time: `--timing instant`.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {
namespace {

using Frame = std::vector<std::uint8_t>;
using std::chrono::microseconds;
using std::chrono::milliseconds;

const Frame kReadOutputs = with_crc({0x01, 0x01, 0x00, 0x00, 0x00, 0x0D});
const Frame kOutputsOff = with_crc({0x01, 0x01, 0x02, 0x00, 0x00});

/// The maximum time from the first byte of a request to the last byte of its reply, at any baud rate.
constexpr microseconds kAtOnce{100};

class InstantLine : public testing::TestWithParam<std::uint32_t> {
 protected:
  explicit InstantLine() {
    line_.come_up();
    line_.master().set_baud(GetParam());
  }

  static std::vector<ModuleSpec> modules() {
    const std::string rate = ",baud=" + std::to_string(GetParam());
    return {parse_module_spec("EX9042D-M@01" + rate), parse_module_spec("EX9043D-M@02" + rate),
            parse_module_spec("EX9042D@03" + rate)};
  }
  void send(const Frame& frame) { line_.master().send(frame.data(), frame.size()); }
  void send(const std::string& text) { send(Frame(text.begin(), text.end())); }
  Frame heard_within(VirtualTime time) {
    heard_.clear();
    line_.wires().run_for(time);
    return heard_;
  }

  Frame heard_;
  Line line_{modules(), kInstant,
             [this](std::uint8_t byte, ByteStatus /*status*/) { heard_.push_back(byte); }};
};

TEST_P(InstantLine, AModbusRequestGetsItsReplyImmediately) {
  send(kReadOutputs);
  EXPECT_EQ(heard_within(kAtOnce), kOutputsOff);
}

TEST_P(InstantLine, TwoPiecesLessThanTwoMillisecondsApartAreOneFrame) {
  for (std::size_t split = 1; split < kReadOutputs.size(); ++split) {
    const auto at = kReadOutputs.begin() + static_cast<std::ptrdiff_t>(split);
    send(Frame(kReadOutputs.begin(), at));
    EXPECT_EQ(heard_within(microseconds(1900)), Frame());
    send(Frame(at, kReadOutputs.end()));
    EXPECT_EQ(heard_within(kAtOnce), kOutputsOff) << split;
    line_.wires().run_for(milliseconds(1));
  }
}

TEST_P(InstantLine, ThreeMillisecondsOfSilenceEndAFrameWithAWrongCrc) {
  send(Frame(kReadOutputs.begin(), kReadOutputs.end() - 1));
  EXPECT_EQ(heard_within(milliseconds(3)), Frame());
  send(kReadOutputs);
  EXPECT_EQ(heard_within(kAtOnce), kOutputsOff);
}

TEST_P(InstantLine, ARequestMayFollowAReplyAfterTheRtuSilence) {
  for (int round = 0; round < 20; ++round) {
    const auto address = static_cast<std::uint8_t>(1 + round % 2);
    const Frame request = with_crc({address, 0x01, 0x00, 0x00, 0x00, 0x08});
    line_.master().send(request.data(), request.size(), line_.clock().virtual_now() + line_.rtu_silence());
    EXPECT_EQ(heard_within(kAtOnce), with_crc({address, 0x01, 0x01, 0x00})) << round;
  }
}

TEST_P(InstantLine, ARequestAtAnotherBaudRateGetsNoReply) {
  line_.master().set_baud(GetParam() == 9600 ? 19200 : 9600);
  send(kReadOutputs);
  EXPECT_EQ(heard_within(milliseconds(10)), Frame());
}

INSTANTIATE_TEST_SUITE_P(Rates, InstantLine, testing::ValuesIn(kBaudRates.begin(), kBaudRates.end()));

}  // namespace
}  // namespace ex9000::sim
