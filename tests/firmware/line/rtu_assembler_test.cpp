// Tests how Modbus RTU frames are assembled and judged: wire.md section 7, "Framing", D9 and D11; Modbus over
// Serial Line V1.02, 2.5.1.
#include "firmware/line/rtu_assembler.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/firmware/line/rtu_bench.hpp"

namespace ex9000 {
namespace {

class RtuAssemblerTest : public testing::Test {
 protected:
  /// Sends one frame and the silence after it. Checks that there is exactly one verdict, and returns the
  /// verdict.
  Verdict verdict_of(const FrameBytes& bytes) {
    wire_.verdicts.clear();
    wire_.frame(bytes);
    EXPECT_EQ(wire_.verdicts.size(), 1U);
    return wire_.verdicts.empty() ? Verdict::Open : wire_.verdicts.front();
  }
  /// Does the same as the other overload, but the byte with the index `errored` has the status `status`.
  Verdict verdict_of(const FrameBytes& bytes, std::size_t errored, ByteStatus status) {
    wire_.verdicts.clear();
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      wire_.byte(bytes[i], i == errored ? status : ByteStatus::Good);
    }
    wire_.rest();
    EXPECT_EQ(wire_.verdicts.size(), 1U);
    return wire_.verdicts.empty() ? Verdict::Open : wire_.verdicts.front();
  }
  void expect_next_frame_accepted() {
    EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
    ASSERT_FALSE(wire_.frames.empty());
    EXPECT_EQ(wire_.frames.back(), without_crc(kChannel0On));
  }

  FrameQueue queue_;
  RtuAssembler assembler_;
  Wire wire_{assembler_, queue_, 9600};
};

// --- verdicts ---

TEST_F(RtuAssemblerTest, AFrameWithACorrectCrcIsAcceptedWithoutItsCrc) {
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  EXPECT_EQ(wire_.frames, std::vector<FrameBytes>{without_crc(kChannel0On)});
}

TEST_F(RtuAssemblerTest, AFrameIsReceivedWhenTheUartReportsItsLastByte) {
  wire_.bytes(kChannel0On);
  const Time end = wire_.time();
  wire_.rest();
  EXPECT_EQ(wire_.received.microseconds(), end.microseconds());
}

TEST_F(RtuAssemblerTest, NothingIsAcceptedBeforeTheSilence) {
  wire_.bytes(kChannel0On);
  EXPECT_TRUE(wire_.verdicts.empty());
}

TEST_F(RtuAssemblerTest, SilenceWithoutAFrameHasNoVerdict) {
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Open);
  EXPECT_TRUE(assembler_.next_wait() == Duration());
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Open);
}

TEST_F(RtuAssemblerTest, AFrameWithAWrongCrcIsDropped) {
  EXPECT_EQ(verdict_of({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B}), Verdict::BadCheck);
  EXPECT_EQ(verdict_of({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x3A, 0x8C}), Verdict::BadCheck);
  EXPECT_TRUE(wire_.frames.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, NoSingleBitFlipIsAccepted) {
  for (std::size_t bit = 0; bit < kChannel0On.size() * 8; ++bit) {
    FrameBytes flipped = kChannel0On;
    flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_EQ(verdict_of(flipped), Verdict::BadCheck) << "bit " << bit;
  }
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, AFrameOfLessThan4BytesIsTooShort) {
  EXPECT_EQ(verdict_of({0x01}), Verdict::TooShort);
  EXPECT_EQ(verdict_of({0x01, 0x11}), Verdict::TooShort);
  EXPECT_EQ(verdict_of(with_crc({0x01})), Verdict::TooShort);
  EXPECT_TRUE(wire_.frames.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, AFrameOf4BytesIsAccepted) {
  EXPECT_EQ(verdict_of({0x01, 0x11, 0xC0, 0x2C}), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), (FrameBytes{0x01, 0x11}));
}

TEST_F(RtuAssemblerTest, AFrameOf256BytesIsAccepted) {
  EXPECT_EQ(verdict_of(frame_of(256)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(frame_of(256)));
}

TEST_F(RtuAssemblerTest, AFrameOfMoreThan256BytesIsTooLongAndTheNextOneIsAccepted) {
  for (const std::size_t size : {257U, 258U, 259U, 300U, 513U, 1000U}) {
    EXPECT_EQ(verdict_of(frame_of(size)), Verdict::TooLong) << size;
    EXPECT_TRUE(wire_.frames.empty());
    expect_next_frame_accepted();
    wire_.frames.clear();
  }
}

TEST_F(RtuAssemblerTest, AFrameOfMoreThan65536BytesIsTooLong) {
  wire_.bytes(FrameBytes(65'540, 0x01));
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::TooLong);
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, OnlyTheOwnAddressAndBroadcastsAreAccepted) {
  for (unsigned address = 0; address < 256; ++address) {
    const FrameBytes frame = frame_of(12, static_cast<std::uint8_t>(address));
    EXPECT_EQ(verdict_of(frame), address == kOwn || address == 0 ? Verdict::Accepted : Verdict::Foreign)
        << address;
  }
  EXPECT_EQ(wire_.frames.size(), 2U);
}

TEST_F(RtuAssemblerTest, EveryModbusAddressCanBeTheAddressOfTheModule) {
  for (unsigned address = 1; address <= 247; ++address) {
    wire_.own = static_cast<std::uint8_t>(address);
    EXPECT_EQ(verdict_of(frame_of(8, wire_.own)), Verdict::Accepted) << address;
  }
}

TEST_F(RtuAssemblerTest, ABroadcastKeepsItsAddress) {
  const FrameBytes broadcast = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});
  EXPECT_EQ(verdict_of(broadcast), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(broadcast));
}

// --- line errors ---

TEST_F(RtuAssemblerTest, AFramingErrorOrBreakAtAnyPositionSpoilsTheFrame) {
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break}) {
    for (std::size_t errored = 0; errored < kChannel0On.size(); ++errored) {
      EXPECT_EQ(verdict_of(kChannel0On, errored, status), Verdict::LineError) << "byte " << errored;
    }
  }
  EXPECT_TRUE(wire_.frames.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, AnOverrunAtAnyPositionLosesTheFrame) {
  for (std::size_t errored = 0; errored < kChannel0On.size(); ++errored) {
    EXPECT_EQ(verdict_of(kChannel0On, errored, ByteStatus::Overrun), Verdict::Overrun) << "byte " << errored;
  }
  EXPECT_TRUE(wire_.frames.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, AnOverrunIsNotReportedAgainForTheNextDamagedFrame) {
  FrameBytes wrong_crc = kChannel0On;
  wrong_crc.back() ^= 0x01;
  ASSERT_EQ(verdict_of(kChannel0On, 2, ByteStatus::Overrun), Verdict::Overrun);
  EXPECT_EQ(verdict_of(wrong_crc, 0, ByteStatus::Good), Verdict::BadCheck);
  ASSERT_EQ(verdict_of(kChannel0On, 2, ByteStatus::Overrun), Verdict::Overrun);
  EXPECT_EQ(verdict_of(kChannel0On, 2, ByteStatus::FramingError), Verdict::LineError);
}

TEST_F(RtuAssemblerTest, ALineErrorSpoilsAForeignAndAShortFrameToo) {
  EXPECT_EQ(verdict_of(frame_of(8, 0x02), 3, ByteStatus::FramingError), Verdict::LineError);
  EXPECT_EQ(verdict_of({0x01, 0x11}, 1, ByteStatus::FramingError), Verdict::LineError);
}

TEST_F(RtuAssemblerTest, AFrameThatIsTooLongAndHasALineErrorIsDropped) {
  const FrameBytes frame = frame_of(300);
  EXPECT_NE(verdict_of(frame, 299, ByteStatus::FramingError), Verdict::Accepted);
  EXPECT_TRUE(wire_.frames.empty());
  expect_next_frame_accepted();
}

// --- a 00 from a line turn-around ---

TEST_F(RtuAssemblerTest, ATurnAround00BeforeAFrameIsRemoved) {
  EXPECT_EQ(verdict_of(behind(0x00, kChannel0On)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(kChannel0On));
}

TEST_F(RtuAssemblerTest, ATurnAround00WithALineErrorIsRemovedToo) {
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break}) {
    EXPECT_EQ(verdict_of(behind(0x00, kChannel0On), 0, status), Verdict::Accepted);
    EXPECT_EQ(wire_.frames.back(), without_crc(kChannel0On));
  }
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeTheLongestFrameIsRemoved) {
  const FrameBytes longest = frame_of(256);
  EXPECT_EQ(verdict_of(behind(0x00, longest)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(longest));
  EXPECT_EQ(verdict_of(behind(0x00, longest), 0, ByteStatus::Break), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(longest));
}

TEST_F(RtuAssemblerTest, AFrameOf257BytesAfterATurnAround00IsTooLong) {
  EXPECT_EQ(verdict_of(behind(0x00, frame_of(257))), Verdict::TooLong);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ABroadcastOf257BytesIsTooLong) {
  EXPECT_EQ(verdict_of(frame_of(257, 0x00)), Verdict::TooLong);
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeTheShortestFrameIsRemoved) {
  EXPECT_EQ(verdict_of({0x00, 0x01, 0x11, 0xC0, 0x2C}), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), (FrameBytes{0x01, 0x11}));
}

TEST_F(RtuAssemblerTest, AFrameThatIsTooShortWithoutTheTurnAround00IsDropped) {
  EXPECT_EQ(verdict_of(behind(0x00, with_crc({0x01}))), Verdict::BadCheck);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeABroadcastIsRemoved) {
  const FrameBytes broadcast = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});
  EXPECT_EQ(verdict_of(behind(0x00, broadcast)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(broadcast));
}

TEST_F(RtuAssemblerTest, ALineErrorInTheAddress00OfABroadcastSpoilsTheFrame) {
  const FrameBytes broadcast = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});
  EXPECT_EQ(verdict_of(broadcast, 0, ByteStatus::FramingError), Verdict::LineError);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeAForeignFrameLeavesItForeign) {
  EXPECT_EQ(verdict_of(behind(0x00, frame_of(8, 0x02))), Verdict::Foreign);
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeAHostOkLeavesItAHostOk) {
  EXPECT_EQ(verdict_of(behind(0x00, with_crc({0x01, 0x03, 0x30, 0x38, 0x00, 0x00}))), Verdict::HostOk);
}

TEST_F(RtuAssemblerTest, OnlyOneTurnAround00IsRemoved) {
  EXPECT_EQ(verdict_of(behind(0x00, behind(0x00, kChannel0On))), Verdict::BadCheck);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, AByteOtherThan00BeforeAFrameIsNotRemoved) {
  for (unsigned first = 1; first < 256; ++first) {
    EXPECT_EQ(verdict_of(behind(static_cast<std::uint8_t>(first), kChannel0On)), Verdict::BadCheck) << first;
  }
  EXPECT_EQ(verdict_of(behind(0xFF, kChannel0On), 0, ByteStatus::FramingError), Verdict::LineError);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ALineErrorAfterTheTurnAround00SpoilsTheFrame) {
  for (std::size_t errored = 1; errored <= kChannel0On.size(); ++errored) {
    EXPECT_EQ(verdict_of(behind(0x00, kChannel0On), errored, ByteStatus::FramingError), Verdict::LineError);
  }
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ATurnAround00FollowedBySilenceIsASeparateFrame) {
  wire_.byte(0x00);
  wire_.silence(t35(9600) + kClock);
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::TooShort, Verdict::Accepted}));
}

// --- host OK ---

TEST_F(RtuAssemblerTest, ReadingRegister3038WithQuantity0Or1IsAHostOk) {
  for (const std::uint8_t address : {kOwn, std::uint8_t{0}}) {
    for (const std::uint8_t function : {std::uint8_t{0x03}, std::uint8_t{0x04}}) {
      for (const std::uint8_t quantity : {std::uint8_t{0}, std::uint8_t{1}}) {
        EXPECT_EQ(verdict_of(with_crc({address, function, 0x30, 0x38, 0x00, quantity})), Verdict::HostOk);
      }
    }
  }
  EXPECT_TRUE(wire_.frames.empty());
  EXPECT_EQ(verdict_of({0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x07}),
            Verdict::HostOk);  // an example frame of wire.md section 7
}

// wire.md section 7.
TEST_F(RtuAssemblerTest, AFrameWhoseFunctionHasBit7SetIsNoRequest) {
  for (unsigned function = 0x80; function <= 0xFF; ++function) {
    for (const int address : {0x00, 0x01}) {
      const FrameBytes frame{static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(function), 0x02};
      EXPECT_EQ(verdict_of(with_crc(frame)), Verdict::Foreign) << function;
    }
  }
}

TEST_F(RtuAssemblerTest, AnotherFunctionRegisterQuantityOrLengthIsNoHostOk) {
  const std::vector<FrameBytes> others{
      {0x01, 0x03, 0x30, 0x38, 0x00, 0x02},                    // quantity
      {0x01, 0x03, 0x30, 0x38, 0x01, 0x00},                    // quantity 256
      {0x01, 0x03, 0x30, 0x38, 0x01, 0x01},                    // quantity 257
      {0x01, 0x04, 0x30, 0x38, 0xFF, 0xFF},                    // quantity
      {0x01, 0x03, 0x30, 0x37, 0x00, 0x01},                    // register
      {0x01, 0x03, 0x30, 0x39, 0x00, 0x01},                    // register
      {0x01, 0x03, 0x38, 0x30, 0x00, 0x01},                    // register
      {0x01, 0x01, 0x30, 0x38, 0x00, 0x01},                    // function
      {0x01, 0x02, 0x30, 0x38, 0x00, 0x00},                    // function
      {0x01, 0x05, 0x30, 0x38, 0x00, 0x00},                    // function
      {0x01, 0x06, 0x30, 0x38, 0x00, 0x01},                    // function
      {0x01, 0x43, 0x30, 0x38, 0x00, 0x01},                    // function
      {0x01, 0x03, 0x30, 0x38},                                // too short
      {0x01, 0x03, 0x30, 0x38, 0x00},                          // too short
      {0x01, 0x03, 0x30, 0x38, 0x00, 0x01, 0x00},              // too long
      {0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0x00, 0x00, 0x00},  // too long
  };
  for (const FrameBytes& other : others) {
    EXPECT_EQ(verdict_of(with_crc(other)), Verdict::Accepted);
    EXPECT_EQ(wire_.frames.back(), other);
  }
}

TEST_F(RtuAssemblerTest, AHostOkForAnotherModuleIsForeign) {
  EXPECT_EQ(verdict_of(with_crc({0x02, 0x03, 0x30, 0x38, 0x00, 0x00})), Verdict::Foreign);
}

TEST_F(RtuAssemblerTest, AFrameWithAWrongCrcIsNotAHostOk) {
  EXPECT_EQ(verdict_of({0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x06}), Verdict::BadCheck);
}

// --- queue space ---

TEST_F(RtuAssemblerTest, AFrameIsAssembledWhileAnotherFrameWaits) {
  wire_.collect = false;
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  wire_.bytes(frame_of(20));
  ASSERT_TRUE(queue_.has_frame());
  EXPECT_EQ(queue_.waiting().bytes().size, kChannel0On.size() - 2);
  queue_.drop_in_main_loop();
  wire_.verdicts.clear();
  wire_.collect = true;
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
  EXPECT_EQ(wire_.frames.back(), without_crc(frame_of(20)));
}

TEST_F(RtuAssemblerTest, AFrameThatEndsWhileAnotherWaitsIsDropped) {
  wire_.collect = false;
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  EXPECT_EQ(verdict_of(frame_of(256)), Verdict::NoRoom);
  EXPECT_EQ(verdict_of(behind(0x00, frame_of(20))), Verdict::NoRoom);
  ASSERT_TRUE(queue_.has_frame());
  const Bytes waiting = queue_.waiting().bytes();
  EXPECT_EQ(FrameBytes(waiting.begin(), waiting.end()), without_crc(kChannel0On));
  queue_.drop_in_main_loop();
  wire_.collect = true;
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, AHostOkAndAForeignFrameAreRecognisedWhileTheQueueIsFull) {
  wire_.collect = false;
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  EXPECT_EQ(verdict_of(with_crc({0x01, 0x03, 0x30, 0x38, 0x00, 0x00})), Verdict::HostOk);
  EXPECT_EQ(verdict_of(frame_of(8, 0x02)), Verdict::Foreign);
}

TEST_F(RtuAssemblerTest, ANewAddressAppliesToAFrameThatIsOpen) {
  wire_.bytes(frame_of(8, 0x02));
  wire_.own = 0x02;
  assembler_.answer_to(0x02);
  wire_.collect = false;
  wire_.rest();
  ASSERT_TRUE(queue_.has_frame());
  EXPECT_EQ(queue_.waiting().size, 6U);
}

// --- after the module's own driver was on ---

TEST_F(RtuAssemblerTest, AnOpenFrameCanBeDiscarded) {
  wire_.bytes({0x01, 0x05, 0x00});
  EXPECT_EQ(assembler_.cut_off(queue_, wire_.time()), Verdict::Open);
  wire_.rest();
  EXPECT_TRUE(wire_.verdicts.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, ACompleteFrameCutOffBeforeItsSilenceIsAccepted) {
  wire_.bytes(kChannel0On);
  EXPECT_EQ(assembler_.cut_off(queue_, wire_.time()), Verdict::Accepted);
  ASSERT_TRUE(queue_.has_frame());
  EXPECT_EQ(queue_.waiting().size, kChannel0On.size() - 2);
  queue_.drop_in_main_loop();
  wire_.rest();
  EXPECT_TRUE(wire_.verdicts.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, TheNextFrameMayFollowADiscardedOneImmediately) {
  wire_.byte(0x01, ByteStatus::FramingError);
  wire_.byte(0x05, ByteStatus::Overrun);
  EXPECT_EQ(assembler_.cut_off(queue_, wire_.time()), Verdict::Open);
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, AFrameInItsGracePeriodCanBeDiscarded) {
  wire_.bytes({0x01, 0x05, 0x00});
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Open);
  ASSERT_FALSE(assembler_.next_wait() == Duration());
  EXPECT_EQ(assembler_.cut_off(queue_, wire_.time()), Verdict::Open);
  EXPECT_TRUE(assembler_.next_wait() == Duration());
  EXPECT_EQ(assembler_.silence(queue_, wire_.time()), Verdict::Open);
  expect_next_frame_accepted();
}

}  // namespace
}  // namespace ex9000
