// Tests the arbitration of one module: extensions.md, scan.
#include "firmware/line/arbitration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "firmware/model/baud.hpp"
#include "sim/app/play/modbus_frame.hpp"

namespace ex9000 {
namespace {

using Round = Arbitration::Round;
using FrameBytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kNumber = 0xFE4000AC;
constexpr std::uint8_t kAddress = 0x2A;
/// The clock wraps during the arbitration.
constexpr Time kReported(0xFFFF'FC00);

class ArbitrationTest : public testing::Test {
 protected:
  void begin(Round round, std::uint32_t number = kNumber, std::uint32_t baud = 9600) {
    now_ = kReported;
    arbitration_.use(LineTiming::at(baud, LineFormat::k8N1));
    arbitration_.begin(round, {number, kAddress}, kReported);
    wait_ = arbitration_.on_time(now_, false, true);
  }
  /// Lets the time until the next window pass. What the module sends at its beginning; its driver is off
  /// again before the next one.
  FrameBytes next(bool line_low = false, bool at_rest = true, Duration late = Duration()) {
    now_ = now_ + wait_ + late;
    wait_ = arbitration_.on_time(now_, line_low, at_rest);
    const Bytes burst = arbitration_.take_burst();
    EXPECT_EQ(arbitration_.take_burst().size, 0U);
    arbitration_.on_sent();
    return {burst.begin(), burst.end()};
  }
  /// All windows, in which nobody else sends. What the module sends, with the reply.
  FrameBytes all() {
    FrameBytes sent;
    while (arbitration_.active()) {
      const FrameBytes burst = next();
      sent.insert(sent.end(), burst.begin(), burst.end());
    }
    return sent;
  }
  static FrameBytes with_bursts(std::size_t bursts, const FrameBytes& frame) {
    FrameBytes all(bursts, 0xFF);
    const FrameBytes reply = with_crc(frame);
    all.insert(all.end(), reply.begin(), reply.end());
    return all;
  }

  Arbitration arbitration_;
  Time now_;
  Duration wait_;
};

// The published captures.
TEST_F(ArbitrationTest, TheOnlyModuleSendsItsZerosAndThenItsReply) {
  begin(Round::First);
  EXPECT_EQ(all(), with_bursts(22, {0xFD, 0x46, 0x03, 0xFE, 0x40, 0x00, 0xAC, kAddress}));
  begin(Round::Next);
  EXPECT_EQ(all(), with_bursts(20, {0xFD, 0x46, 0x04}));
  begin(Round::First);
  EXPECT_EQ(all().size(), 22U + 10U);
  begin(Round::First, 0xFED2A3A6);
  EXPECT_EQ(all().size(), 15U + 10U);
}

TEST_F(ArbitrationTest, TheFirstRoundAfterAResetMayBeANextRound) {
  begin(Round::Next);
  EXPECT_EQ(all(), with_bursts(22, {0xFD, 0x46, 0x03, 0xFE, 0x40, 0x00, 0xAC, kAddress}));
}

// 3.5 characters of 12 bits, at least 800 us rounded up to whole bits; then windows of at least 13 bits, or
// of 12 bits and 50 us rounded up to whole bits. The report of the last byte is at the end of its stop bit.
TEST_F(ArbitrationTest, WindowsKeepTheirTimesAtAllRates) {
  for (const std::uint32_t baud : kBaudRates) {
    const double bit = 1e6 / baud;
    const double first = std::max(42.0, std::ceil(800 / bit)) * bit;
    const double window = std::max(13.0, 12 + std::ceil(50 / bit)) * bit;
    begin(Round::First, kNumber, baud);
    for (unsigned each = 0; arbitration_.active(); ++each) {
      next();
      EXPECT_NEAR(now_.since(kReported).microseconds(), first + each * window, 2) << baud << " " << each;
    }
    EXPECT_NEAR(now_.since(kReported).microseconds(), first + 32 * window, 2) << baud;
  }
}

TEST_F(ArbitrationTest, ALateInterruptDelaysOnlyItsOwnWindow) {
  begin(Round::First);
  next();
  next(false, true, Duration(300));
  next();
  EXPECT_NEAR(now_.since(kReported).microseconds(), 4375 + 2 * 1354, 2);
}

// FE4000AC: 0110 1110 0100 ... The second window is that of a 1.
TEST_F(ArbitrationTest, AByteInTheWindowOfAOneLoses) {
  begin(Round::First);
  EXPECT_EQ(next(), FrameBytes{0xFF});
  EXPECT_EQ(next(), FrameBytes{});
  EXPECT_FALSE(arbitration_.hears_byte()) << "the byte may begin a frame";
  EXPECT_FALSE(arbitration_.active());
}

TEST_F(ArbitrationTest, AByteInTheWindowOfAZeroDoesNotMatter) {
  begin(Round::First);
  EXPECT_EQ(next(true), FrameBytes{}) << "another module has begun to send";
  EXPECT_TRUE(arbitration_.hears_byte());
  EXPECT_TRUE(arbitration_.active());
  EXPECT_EQ(all(), with_bursts(21, {0xFD, 0x46, 0x03, 0xFE, 0x40, 0x00, 0xAC, kAddress}));
}

TEST_F(ArbitrationTest, AByteBeforeTheFirstWindowEndsIt) {
  begin(Round::First);
  EXPECT_FALSE(arbitration_.hears_byte());
  EXPECT_FALSE(arbitration_.active());
}

TEST_F(ArbitrationTest, AByteInTheLastWindowLoses) {
  begin(Round::First, 0xFE4000AD);
  for (unsigned window = 0; window < 32; ++window) {
    next();
  }
  EXPECT_FALSE(arbitration_.hears_byte());
  EXPECT_FALSE(arbitration_.active());
}

TEST_F(ArbitrationTest, AModuleThatProcessesARequestInTheFirstWindowTakesNoPart) {
  begin(Round::First);
  EXPECT_EQ(next(false, false), FrameBytes{});
  EXPECT_FALSE(arbitration_.active());
}

TEST_F(ArbitrationTest, AnInterruptThatIsLateByAWindowGivesUp) {
  begin(Round::First);
  next();
  EXPECT_EQ(next(false, true, Duration(1355)), FrameBytes{});
  EXPECT_FALSE(arbitration_.active());
}

TEST_F(ArbitrationTest, ABurstThatDoesNotEndGivesUpAndJams) {
  begin(Round::First);
  now_ = now_ + wait_;
  wait_ = arbitration_.on_time(now_, false, true);
  EXPECT_EQ(arbitration_.take_burst().size, 1U);
  const Time begun = now_;
  now_ = now_ + wait_;
  EXPECT_EQ(arbitration_.on_time(now_, false, true), Duration()) << "the driver is still on";
  EXPECT_EQ(arbitration_.take_burst().size, 0U);
  EXPECT_FALSE(arbitration_.active());
  EXPECT_FALSE(arbitration_.jams(begun + milliseconds(100)));
  EXPECT_TRUE(arbitration_.jams(begun + milliseconds(111)));
  arbitration_.on_sent();
  EXPECT_FALSE(arbitration_.jams(begun + milliseconds(111)));
}

TEST_F(ArbitrationTest, OnlyAModuleThatHasRepliedIsScanned) {
  begin(Round::First);
  next();
  next();
  arbitration_.hears_byte();
  begin(Round::Next);
  EXPECT_EQ(all(), with_bursts(22, {0xFD, 0x46, 0x03, 0xFE, 0x40, 0x00, 0xAC, kAddress}));
}

}  // namespace
}  // namespace ex9000
