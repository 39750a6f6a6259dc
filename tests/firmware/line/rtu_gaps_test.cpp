// Tests the silences between RTU frames and the gaps within RTU frames. T3.5 and T1.5 count from the end of
// the last stop bit of a byte to the next start bit: wire.md section 7, "Framing", and D11; Modbus over
// Serial Line V1.02, 2.5.1.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>

#include "firmware/line/rtu_assembler.hpp"
#include "firmware/model/baud.hpp"
#include "tests/firmware/line/rtu_bench.hpp"

namespace ex9000 {
namespace {

class RtuGaps : public testing::TestWithParam<std::tuple<std::uint32_t, LineFormat>> {
 protected:
  /// Sends the first `split` bytes of `frame`, a gap, the other bytes, and the silence that ends the frame.
  void with_gap(const FrameBytes& frame, std::size_t split, Nanoseconds gap) {
    const auto middle = frame.begin() + static_cast<std::ptrdiff_t>(split);
    wire_.bytes({frame.begin(), middle});
    wire_.silence(gap);
    wire_.frame({middle, frame.end()});
  }
  std::uint32_t baud_ = std::get<0>(GetParam());
  LineFormat format_ = std::get<1>(GetParam());
  FrameQueue queue_;
  RtuAssembler assembler_;
  Wire wire_{assembler_, queue_, baud_, format_};
};

// The master of a simulated line can have other baud rates than a module, up to 4 Mbaud.
TEST(LineTimingAt, FourMegabaudHasAGraceOfOneMicrosecond) {
  EXPECT_EQ(LineTiming::at(4'000'000, LineFormat::k8N1).rtu_grace.microseconds(), 1U);
}

constexpr std::array<LineFormat, 4> kFormats{LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1,
                                             LineFormat::k8O1};

std::string name_of(const testing::TestParamInfo<RtuGaps::ParamType>& mode) {
  constexpr std::array<const char*, 4> kNames{"8N1", "8N2", "8E1", "8O1"};
  const auto [baud, format] = mode.param;
  return "Baud" + std::to_string(baud) + "Format" + kNames.at(static_cast<std::size_t>(format));
}

// T1.5 and T3.5 are the same in every format: up to 19200 baud they are multiples of half a character of 11
// bits, and above 19200 baud they are fixed.
INSTANTIATE_TEST_SUITE_P(AllRatesAndFormats, RtuGaps,
                         testing::Combine(testing::ValuesIn(kBaudRates), testing::ValuesIn(kFormats)),
                         name_of);

TEST_P(RtuGaps, AGapShorterThanT35DoesNotEndTheFrame) {
  for (std::size_t split = 1; split < kChannel0On.size(); ++split) {
    wire_.verdicts.clear();
    with_gap(kChannel0On, split, t35(baud_) - kClock);
    EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted}) << "after byte " << split;
  }
}

TEST_P(RtuGaps, SeveralGapsWithinAFrameAreTolerated) {
  for (const std::uint8_t byte : kChannel0On) {
    wire_.silence(t35(baud_) - kClock);
    wire_.byte(byte);
  }
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, AGapOfT35EndsTheFrame) {
  with_gap(kChannel0On, 4, t35(baud_));
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::BadCheck, Verdict::BadCheck}));
}

TEST_P(RtuGaps, AGapLongerThanT35EndsTheFrame) {
  with_gap(kChannel0On, 2, t35(baud_) + kClock);
  with_gap(kChannel0On, 2, t35(baud_) + wire_.character());
  with_gap(kChannel0On, 2, 20 * t35(baud_));
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::TooShort, Verdict::BadCheck, Verdict::TooShort,
                                      Verdict::BadCheck, Verdict::TooShort, Verdict::BadCheck}));
}

TEST_P(RtuGaps, AFrameThatBeginsT35AfterAnotherFrameIsSeparate) {
  for (const Nanoseconds gap : {t35(baud_), t35(baud_) + kClock, 2 * t35(baud_)}) {
    wire_.verdicts.clear();
    wire_.bytes(kChannel0On);
    wire_.silence(gap);
    wire_.frame(frame_of(12));
    EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::Accepted, Verdict::Accepted})) << gap;
    EXPECT_EQ(wire_.frames.back(), without_crc(frame_of(12)));
  }
}

TEST_P(RtuGaps, AFrameThatBeginsT35AfterAnInvalidFrameIsSeparate) {
  wire_.bytes({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B});
  wire_.silence(t35(baud_));
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::BadCheck, Verdict::Accepted}));
}

TEST_P(RtuGaps, AFrameThatBeginsT35AfterAnInvalidFrameIsSeparateEvenIfTheTimerIsLate) {
  wire_.late_by = 5;
  wire_.bytes({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B});
  wire_.silence(t35(baud_));
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::BadCheck, Verdict::Accepted}));
}

TEST_P(RtuGaps, AByteThatEndsWithinT35BelongsToTheFrameEvenIfTheCrcWasCorrect) {
  wire_.bytes(kChannel0On);
  wire_.silence(t35(baud_) - wire_.character() - kClock);
  wire_.byte(0x55);
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::BadCheck});
}

TEST_P(RtuGaps, AFrameWithACorrectCrcEndsAtT35EvenIfAByteIsBeingReceived) {
  wire_.bytes(kChannel0On);
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.byte(0x55);
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::Accepted, Verdict::TooShort}));
}

TEST_P(RtuGaps, AWrongCrcAtT35ExtendsTheWaitOnce) {
  wire_.bytes({0x01, 0x05, 0x00});
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Open);
  EXPECT_FALSE(assembler_.next_wait() == Duration());
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::TooShort);
  EXPECT_TRUE(assembler_.next_wait() == Duration());
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Open);
}

TEST_P(RtuGaps, AByteThatStartsBeforeT35ContinuesAnIncompleteFrame) {
  wire_.bytes({0x01, 0x05, 0x00});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.byte(0x00);
  EXPECT_TRUE(wire_.verdicts.empty());
  EXPECT_TRUE(assembler_.next_wait() == Duration());
  wire_.frame({0xFF, 0x00, 0x8C, 0x3A});
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, AFrameMayHaveMoreThanOneGracePeriod) {
  wire_.bytes({0x01, 0x05, 0x00});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.bytes({0x00, 0xFF});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.frame({0x00, 0x8C, 0x3A});
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, IfAFrameIsTooLongAByteThatIsBeingReceivedAtT35BelongsToThisFrame) {
  wire_.bytes(FrameBytes(258, 0x02));
  for (int i = 0; i < 3; ++i) {
    wire_.silence(t35(baud_) - wire_.character() / 2);
    wire_.byte(0x02);
  }
  EXPECT_EQ(wire_.verdicts, Verdicts{});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::TooLong});
}

TEST_P(RtuGaps, ACorrectCrcAtT35IsAcceptedImmediately) {
  wire_.bytes(kChannel0On);
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Accepted);
  EXPECT_TRUE(assembler_.next_wait() == Duration());
}

TEST_P(RtuGaps, TheSilenceEndsT35AfterTheLastByteAndNeverEarlier) {
  for (const std::uint8_t byte : kChannel0On) {
    wire_.byte(byte);
    const Nanoseconds second_stop_bit = format_ == LineFormat::k8N2 ? 1'000'000'000 / baud_ : 0;
    const Nanoseconds over =
        Nanoseconds{assembler_.timing().rtu_silence.microseconds()} * 1000 - second_stop_bit;
    EXPECT_GE(over, t35(baud_));
    EXPECT_LE(over, t35(baud_) + 5'000);
  }
}

// Some UARTs report a byte in the middle of its first stop bit, half a bit before the end of this stop bit. A
// silence that counts from the report is therefore half a bit longer.
TEST_P(RtuGaps, SilencesAreHalfABitLongerIfTheUartReportsBytesInTheStopBit) {
  const LineTiming end = LineTiming::at(baud_, format_);
  const LineTiming middle = LineTiming::reported_in_stop_bit(baud_, format_);
  const std::uint32_t half_bit = 500'000 / baud_;
  for (const auto silence : {&LineTiming::rtu_silence, &LineTiming::dcon_turn_around}) {
    const std::uint32_t longer = (middle.*silence).microseconds() - (end.*silence).microseconds();
    EXPECT_GT(longer, half_bit);
    EXPECT_LE(longer, half_bit + 1);
  }
  // The time between the reports of two bytes is the same, because both reports are half a bit earlier.
  EXPECT_TRUE(middle.rtu_silence + middle.rtu_grace == end.rtu_silence + end.rtu_grace);
  EXPECT_TRUE(middle.rtu_slack == end.rtu_slack);
}

// In `LineTiming::at`, the UART reports a byte at the end of its first stop bit. Only 8N2 has a second stop
// bit. `rest_of_stop_bit` is the time from the report of a byte to the end of its last stop bit. The response
// delay counts from the end of the last stop bit of a request, so the module adds `rest_of_stop_bit` to the
// delay.
TEST_P(RtuGaps, TheTimeToTheEndOfTheLastStopBitIsRoundedUp) {
  const std::uint32_t rest = LineTiming::at(baud_, format_).rest_of_stop_bit.microseconds();
  const std::uint32_t exact = format_ == LineFormat::k8N2 ? 1'000'000 : 0;  // in microseconds times baud
  EXPECT_GE(rest * baud_, exact);
  EXPECT_LE(rest * baud_, exact + baud_);
}

TEST_P(RtuGaps, StrictTimingAllowsTheSameGapsIfTheUartReportsBytesInTheStopBit) {
  const LineTiming end = LineTiming::strictly_at(baud_, format_);
  const LineTiming middle = LineTiming::strictly_reported_in_stop_bit(baud_, format_);
  EXPECT_TRUE(middle.rtu_slack == end.rtu_slack);
  EXPECT_TRUE(middle.rtu_silence == LineTiming::reported_in_stop_bit(baud_, format_).rtu_silence);
}

TEST_P(RtuGaps, AFrameAcrossTheWrapOfTheClockIsOneFrame) {
  for (const std::uint32_t before : {1U, 100U, 3000U, 9000U, 40'000U}) {
    wire_.verdicts.clear();
    wire_.start_at(Time(0U - before));
    with_gap(kChannel0On, 4, t35(baud_) - kClock);
    EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted}) << before;
  }
}

TEST_P(RtuGaps, StrictTimingRejectsAGapLongerThanT15) {
  assembler_.use(LineTiming::strictly_at(baud_, format_));
  for (std::size_t split = 1; split < kChannel0On.size(); ++split) {
    wire_.verdicts.clear();
    with_gap(kChannel0On, split, t15(baud_) + kClock);
    ASSERT_EQ(wire_.verdicts.size(), 1U) << "after byte " << split;
    EXPECT_NE(wire_.verdicts.front(), Verdict::Accepted) << "after byte " << split;
  }
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_P(RtuGaps, StrictTimingAllowsAGapOfT15) {
  assembler_.use(LineTiming::strictly_at(baud_, format_));
  for (std::size_t split = 1; split < kChannel0On.size(); ++split) {
    wire_.verdicts.clear();
    with_gap(kChannel0On, split, t15(baud_));
    EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted}) << "after byte " << split;
  }
}

TEST_P(RtuGaps, AfterASpoiledFrameStrictTimingAcceptsAFrameWithoutGaps) {
  assembler_.use(LineTiming::strictly_at(baud_, format_));
  with_gap(kChannel0On, 4, t15(baud_) + kClock);
  wire_.verdicts.clear();
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, StrictTimingDoesNotEndAFrameAtAGapShorterThanT35) {
  assembler_.use(LineTiming::strictly_at(baud_, format_));
  with_gap(frame_of(20), 12, t35(baud_) - kClock);
  EXPECT_EQ(wire_.verdicts.size(), 1U);
  EXPECT_TRUE(wire_.frames.empty());
}

// A gap of more than T1.5 within a frame makes the frame invalid. A gap after the 00 is before the frame,
// because the 00 does not belong to the frame.
TEST_P(RtuGaps, StrictTimingAllowsAGapAfterATurnAround00) {
  assembler_.use(LineTiming::strictly_at(baud_, format_));
  with_gap(behind(0x00, kChannel0On), 1, t15(baud_) + kClock);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

// The module supervises its replies with this time (wire.md section 6, module watchdog).
TEST(LineTiming, ACharacterIsRoundedUpByAtMostAMicrosecond) {
  for (const std::uint32_t baud : kBaudRates) {
    for (const LineFormat format : {LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1, LineFormat::k8O1}) {
      const std::uint64_t bits = format == LineFormat::k8N1 ? 10 : 11;
      const std::uint64_t character = LineTiming::at(baud, format).character.microseconds();
      EXPECT_GE(character * baud, bits * 1'000'000) << baud;
      EXPECT_LE((character - 1) * baud, bits * 1'000'000) << baud;
    }
  }
}

}  // namespace
}  // namespace ex9000
