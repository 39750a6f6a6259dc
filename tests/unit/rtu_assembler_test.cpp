// Assembling Modbus RTU frames: wire.md section 7, "Framing", and D11; Modbus over Serial Line V1.02, 2.5.1.
#include "firmware/line/rtu_assembler.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ex9000 {
namespace {

using FrameBytes = std::vector<std::uint8_t>;
using Verdicts = std::vector<Verdict>;
using Nanoseconds = std::int64_t;

constexpr std::uint8_t kOwn = 0x01;
constexpr Duration kLongSilence = milliseconds(100);

/// Bit by bit, as appendix B of the guide describes it.
FrameBytes with_crc(FrameBytes bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xA001U : crc >> 1U;
    }
  }
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return bytes;
}

const FrameBytes kChannel0On{0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A};  // wire.md, worked out

/// `size` bytes, CRC included.
FrameBytes frame_of(std::size_t size, std::uint8_t address = kOwn) {
  FrameBytes bytes{address, 0x10};
  while (bytes.size() < size - 2) {
    bytes.push_back(static_cast<std::uint8_t>(bytes.size() * 11 + 5));
  }
  return with_crc(bytes);
}

FrameBytes without_crc(const FrameBytes& frame) { return {frame.begin(), frame.end() - 2}; }

FrameBytes behind(std::uint8_t first, const FrameBytes& frame) {
  FrameBytes bytes{first};
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  return bytes;
}

/// T1.5 and T3.5 as the guide has them: 11-bit characters up to 19200 baud, 750 and 1750 microseconds above.
Nanoseconds silence_of_half_characters(int halves, std::uint32_t baud, Nanoseconds fixed) {
  return baud <= 19200 ? Nanoseconds{halves} * 11 * 500'000'000 / baud : fixed;
}
Nanoseconds t15(std::uint32_t baud) { return silence_of_half_characters(3, baud, 750'000); }
Nanoseconds t35(std::uint32_t baud) { return silence_of_half_characters(7, baud, 1'750'000); }

/// The assembler's clock shows whole microseconds, and the times it compares with are rounded to them.
constexpr Nanoseconds kClock = 5'000;

/// A wire at one rate, with the silence timer beside it. A byte takes ten bits; the assembler is told at its
/// end.
class Wire {
 public:
  Wire(RtuAssembler& assembler, FrameQueue& queue, std::uint32_t baud)
      : assembler_(assembler), queue_(queue), baud_(baud), timing_(LineTiming::at(baud)) {
    assembler_.use(timing_, InterCharacterGap::Tolerated);
  }

  [[nodiscard]] Nanoseconds character() const { return Nanoseconds{10} * 1'000'000'000 / baud_; }

  void byte(std::uint8_t value, ByteStatus status = ByteStatus::Good) {
    now_ += character();
    run_timer();
    note(assembler_.byte(value, status, own, time()));
    due_ = now_ / 1000 + timing_.rtu_silence.microseconds();
  }
  void bytes(const FrameBytes& values) {
    for (const std::uint8_t value : values) {
      byte(value);
    }
  }
  /// Between a stop bit and the next start bit.
  void silence(Nanoseconds length) { now_ += length; }
  /// Until no timer runs.
  void rest() {
    silence(1'000'000'000);
    run_timer();
  }
  void frame(const FrameBytes& values) {
    bytes(values);
    rest();
  }

  [[nodiscard]] Time time() const { return Time(static_cast<std::uint32_t>(now_ / 1000)); }
  void start_at(Time time) { now_ = Nanoseconds{time.microseconds()} * 1000; }

  std::uint8_t own = kOwn;
  bool timer_works = true;
  bool collect = true;  ///< frames are taken as they come
  Verdicts verdicts;
  std::vector<FrameBytes> frames;
  Time received;  ///< the latest frame's

 private:
  void run_timer() {
    while (timer_works && due_ && *due_ < now_ / 1000) {
      note(assembler_.silence(own, Time(static_cast<std::uint32_t>(*due_))));
      if (assembler_.wants_more_silence()) {
        *due_ += timing_.character.microseconds();
      } else {
        due_.reset();
      }
    }
  }
  void note(Verdict verdict) {
    if (verdict == Verdict::Open) {
      return;
    }
    verdicts.push_back(verdict);
    const Frame* frame = queue_.waiting();
    if (collect && frame != nullptr) {
      frames.emplace_back(frame->bytes().begin(), frame->bytes().end());
      received = frame->received;
      queue_.drop_in_main_loop();
    }
  }

  RtuAssembler& assembler_;
  FrameQueue& queue_;
  Nanoseconds baud_;
  LineTiming timing_;
  Nanoseconds now_ = 1'000'000'000;
  std::optional<Nanoseconds> due_;  // microseconds
};

class RtuAssemblerTest : public testing::Test {
 protected:
  /// What one frame comes to, with silence before and behind it.
  Verdict verdict_of(const FrameBytes& bytes) {
    wire_.verdicts.clear();
    wire_.frame(bytes);
    EXPECT_EQ(wire_.verdicts.size(), 1U);
    return wire_.verdicts.empty() ? Verdict::Open : wire_.verdicts.front();
  }
  /// Likewise with a line error in byte `errored`.
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
  RtuAssembler assembler_{queue_};
  Wire wire_{assembler_, queue_, 9600};
};

// --- verdicts ---

TEST_F(RtuAssemblerTest, AFrameWithARightCrcIsAcceptedWithoutItsCrc) {
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  EXPECT_EQ(wire_.frames, std::vector<FrameBytes>{without_crc(kChannel0On)});
}

TEST_F(RtuAssemblerTest, AFrameIsReceivedWhenItsLastByteIsComplete) {
  wire_.bytes(kChannel0On);
  const Time end = wire_.time();
  wire_.rest();
  EXPECT_EQ(wire_.received.microseconds(), end.microseconds());
}

TEST_F(RtuAssemblerTest, NothingIsAcceptedBeforeTheSilence) {
  wire_.bytes(kChannel0On);
  EXPECT_TRUE(wire_.verdicts.empty());
}

TEST_F(RtuAssemblerTest, SilenceWithoutAFrameIsNothing) {
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Open);
  EXPECT_FALSE(assembler_.wants_more_silence());
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Open);
}

TEST_F(RtuAssemblerTest, AWrongCrcIsDropped) {
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

TEST_F(RtuAssemblerTest, AFrameOfMoreThan256BytesIsTooLongAndTheNextOneAccepted) {
  for (const std::size_t size : {257U, 258U, 259U, 300U, 513U, 1000U}) {
    EXPECT_EQ(verdict_of(frame_of(size)), Verdict::TooLong) << size;
    EXPECT_TRUE(wire_.frames.empty());
    expect_next_frame_accepted();
    wire_.frames.clear();
  }
}

TEST_F(RtuAssemblerTest, AFrameTooLongForAnyCounterIsTooLong) {
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

TEST_F(RtuAssemblerTest, EveryModbusAddressCanBeTheOwnOne) {
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

TEST_F(RtuAssemblerTest, ALineErrorSpoilsAForeignAndAShortFrameToo) {
  EXPECT_EQ(verdict_of(frame_of(8, 0x02), 3, ByteStatus::FramingError), Verdict::LineError);
  EXPECT_EQ(verdict_of({0x01, 0x11}, 1, ByteStatus::FramingError), Verdict::LineError);
}

TEST_F(RtuAssemblerTest, ALineErrorFarBehindTheLongestFrameLosesItAllTheSame) {
  const FrameBytes frame = frame_of(300);
  EXPECT_NE(verdict_of(frame, 299, ByteStatus::FramingError), Verdict::Accepted);
  EXPECT_TRUE(wire_.frames.empty());
  expect_next_frame_accepted();
}

// --- a 00 from a line turn-around ---

TEST_F(RtuAssemblerTest, ATurnAround00BeforeAFrameIsTakenOff) {
  EXPECT_EQ(verdict_of(behind(0x00, kChannel0On)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(kChannel0On));
}

TEST_F(RtuAssemblerTest, ATurnAround00WithALineErrorIsTakenOffToo) {
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break}) {
    EXPECT_EQ(verdict_of(behind(0x00, kChannel0On), 0, status), Verdict::Accepted);
    EXPECT_EQ(wire_.frames.back(), without_crc(kChannel0On));
  }
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeTheLongestFrameIsTakenOff) {
  const FrameBytes longest = frame_of(256);
  EXPECT_EQ(verdict_of(behind(0x00, longest)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(longest));
  EXPECT_EQ(verdict_of(behind(0x00, longest), 0, ByteStatus::Break), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(longest));
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeAFrameOf257BytesDoesNotMakeItShorter) {
  EXPECT_EQ(verdict_of(behind(0x00, frame_of(257))), Verdict::TooLong);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ABroadcastOf257BytesIsTooLong) {
  EXPECT_EQ(verdict_of(frame_of(257, 0x00)), Verdict::TooLong);
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeTheShortestFrameIsTakenOff) {
  EXPECT_EQ(verdict_of({0x00, 0x01, 0x11, 0xC0, 0x2C}), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), (FrameBytes{0x01, 0x11}));
}

TEST_F(RtuAssemblerTest, WhatIsTooShortWithoutTheTurnAround00IsDropped) {
  EXPECT_EQ(verdict_of(behind(0x00, with_crc({0x01}))), Verdict::BadCheck);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ATurnAround00BeforeABroadcastIsTakenOff) {
  const FrameBytes broadcast = with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00});
  EXPECT_EQ(verdict_of(behind(0x00, broadcast)), Verdict::Accepted);
  EXPECT_EQ(wire_.frames.back(), without_crc(broadcast));
}

TEST_F(RtuAssemblerTest, TheFirst00OfABroadcastIsItsAddressAndNoTurnAround) {
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

TEST_F(RtuAssemblerTest, OnlyOneTurnAround00IsTakenOff) {
  EXPECT_EQ(verdict_of(behind(0x00, behind(0x00, kChannel0On))), Verdict::BadCheck);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, NoOtherByteIsTakenOff) {
  for (unsigned first = 1; first < 256; ++first) {
    EXPECT_EQ(verdict_of(behind(static_cast<std::uint8_t>(first), kChannel0On)), Verdict::BadCheck) << first;
  }
  EXPECT_EQ(verdict_of(behind(0xFF, kChannel0On), 0, ByteStatus::FramingError), Verdict::LineError);
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ALineErrorBehindTheTurnAround00SpoilsTheFrame) {
  for (std::size_t errored = 1; errored <= kChannel0On.size(); ++errored) {
    EXPECT_EQ(verdict_of(behind(0x00, kChannel0On), errored, ByteStatus::FramingError), Verdict::LineError);
  }
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_F(RtuAssemblerTest, ATurnAround00WithSilenceBehindItIsAFrameOfItsOwn) {
  wire_.byte(0x00);
  wire_.silence(t35(9600) + kClock);
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::TooShort, Verdict::Accepted}));
}

// --- host OK ---

TEST_F(RtuAssemblerTest, HostOkIsFunction03Or04OfRegister3038WithQuantity0Or1AtTheOwnAddressOr0) {
  for (const std::uint8_t address : {kOwn, std::uint8_t{0}}) {
    for (const std::uint8_t function : {std::uint8_t{0x03}, std::uint8_t{0x04}}) {
      for (const std::uint8_t quantity : {std::uint8_t{0}, std::uint8_t{1}}) {
        EXPECT_EQ(verdict_of(with_crc({address, function, 0x30, 0x38, 0x00, quantity})), Verdict::HostOk);
      }
    }
  }
  EXPECT_TRUE(wire_.frames.empty());
  EXPECT_EQ(verdict_of({0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x07}),
            Verdict::HostOk);  // wire.md, worked out
}

TEST_F(RtuAssemblerTest, NothingElseIsAHostOk) {
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
      {0x01, 0x83, 0x30, 0x38, 0x00, 0x01},                    // function
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

TEST_F(RtuAssemblerTest, AHostOkWithAWrongCrcIsNone) {
  EXPECT_EQ(verdict_of({0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x06}), Verdict::BadCheck);
}

// --- room ---

TEST_F(RtuAssemblerTest, AFrameIsAssembledWhileOneWaits) {
  wire_.collect = false;
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  wire_.bytes(frame_of(20));
  ASSERT_NE(queue_.waiting(), nullptr);
  EXPECT_EQ(queue_.waiting()->bytes().size, kChannel0On.size() - 2);
  queue_.drop_in_main_loop();
  wire_.verdicts.clear();
  wire_.collect = true;
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
  EXPECT_EQ(wire_.frames.back(), without_crc(frame_of(20)));
}

TEST_F(RtuAssemblerTest, AFrameThatEndsWhileOneWaitsHasNoRoomAndLeavesTheOtherAlone) {
  wire_.collect = false;
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  EXPECT_EQ(verdict_of(frame_of(256)), Verdict::NoRoom);
  EXPECT_EQ(verdict_of(behind(0x00, frame_of(20))), Verdict::NoRoom);
  ASSERT_NE(queue_.waiting(), nullptr);
  const Bytes waiting = queue_.waiting()->bytes();
  EXPECT_EQ(FrameBytes(waiting.begin(), waiting.end()), without_crc(kChannel0On));
  queue_.drop_in_main_loop();
  wire_.collect = true;
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, AHostOkAndAForeignFrameNeedNoRoom) {
  wire_.collect = false;
  EXPECT_EQ(verdict_of(kChannel0On), Verdict::Accepted);
  EXPECT_EQ(verdict_of(with_crc({0x01, 0x03, 0x30, 0x38, 0x00, 0x00})), Verdict::HostOk);
  EXPECT_EQ(verdict_of(frame_of(8, 0x02)), Verdict::Foreign);
}

// --- the own driver comes on ---

TEST_F(RtuAssemblerTest, AnOpenFrameCanBeForgotten) {
  wire_.bytes({0x01, 0x05, 0x00});
  EXPECT_EQ(assembler_.cut_off(kOwn), Verdict::Open);
  wire_.rest();
  EXPECT_TRUE(wire_.verdicts.empty());
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, TheNextFrameMayFollowAForgottenOneAtOnce) {
  wire_.byte(0x01, ByteStatus::FramingError);
  wire_.byte(0x05, ByteStatus::Overrun);
  EXPECT_EQ(assembler_.cut_off(kOwn), Verdict::Open);
  expect_next_frame_accepted();
}

TEST_F(RtuAssemblerTest, ALapsedFrameCanBeForgotten) {
  wire_.bytes({0x01, 0x05, 0x00});
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Open);
  ASSERT_TRUE(assembler_.wants_more_silence());
  EXPECT_EQ(assembler_.cut_off(kOwn), Verdict::Open);
  EXPECT_FALSE(assembler_.wants_more_silence());
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Open);
  expect_next_frame_accepted();
}

// --- gaps, as T3.5 and T1.5 count them: from a stop bit to the next start bit ---

class RtuGaps : public testing::TestWithParam<std::uint32_t> {
 protected:
  /// The first `split` bytes, a gap, the others.
  void with_gap(const FrameBytes& frame, std::size_t split, Nanoseconds gap) {
    const auto middle = frame.begin() + static_cast<std::ptrdiff_t>(split);
    wire_.bytes({frame.begin(), middle});
    wire_.silence(gap);
    wire_.frame({middle, frame.end()});
  }
  std::uint32_t baud_ = GetParam();
  FrameQueue queue_;
  RtuAssembler assembler_{queue_};
  Wire wire_{assembler_, queue_, baud_};
};

INSTANTIATE_TEST_SUITE_P(AllRates, RtuGaps, testing::ValuesIn(kBaudRates),
                         [](const auto& rate) { return "Baud" + std::to_string(rate.param); });

TEST_P(RtuGaps, AGapShorterThanT35StaysWithinTheFrame) {
  for (std::size_t split = 1; split < kChannel0On.size(); ++split) {
    wire_.verdicts.clear();
    with_gap(kChannel0On, split, t35(baud_) - kClock);
    EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted}) << "behind byte " << split;
  }
}

TEST_P(RtuGaps, AGapShorterThanT35StaysWithinTheFrameWhenTheTimerIsLate) {
  wire_.timer_works = false;
  wire_.bytes({0x01, 0x05, 0x00});
  wire_.silence(t35(baud_) - kClock);
  wire_.bytes({0x00, 0xFF, 0x00, 0x8C, 0x3A});
  wire_.timer_works = true;
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
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

TEST_P(RtuGaps, AFrameT35BehindAnotherIsOneOfItsOwn) {
  for (const Nanoseconds gap : {t35(baud_), t35(baud_) + kClock, 2 * t35(baud_)}) {
    wire_.verdicts.clear();
    wire_.bytes(kChannel0On);
    wire_.silence(gap);
    wire_.frame(frame_of(12));
    EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::Accepted, Verdict::Accepted})) << gap;
    EXPECT_EQ(wire_.frames.back(), without_crc(frame_of(12)));
  }
}

TEST_P(RtuGaps, AFrameT35BehindABrokenOneIsOneOfItsOwn) {
  wire_.bytes({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B});
  wire_.silence(t35(baud_));
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::BadCheck, Verdict::Accepted}));
}

TEST_P(RtuGaps, AFrameT35BehindAnotherIsOneOfItsOwnWhenTheTimerIsLate) {
  wire_.timer_works = false;
  wire_.bytes(kChannel0On);
  const Time end = wire_.time();
  wire_.silence(t35(baud_));
  wire_.byte(0x01);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
  EXPECT_EQ(wire_.received.microseconds(), end.microseconds());
  wire_.timer_works = true;
  wire_.frame({0x11, 0xC0, 0x2C});
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::Accepted, Verdict::Accepted}));
}

TEST_P(RtuGaps, AFrameT35BehindABrokenOneIsOneOfItsOwnWhenTheTimerIsLate) {
  wire_.timer_works = false;
  wire_.bytes({0x01, 0x05, 0x00, 0x00});
  wire_.silence(t35(baud_));
  wire_.bytes(kChannel0On);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::BadCheck});
  wire_.timer_works = true;
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::BadCheck, Verdict::Accepted}));
}

TEST_P(RtuGaps, AByteThatIsCompleteWithinT35BelongsToTheFrameWhateverItsCrc) {
  wire_.bytes(kChannel0On);
  wire_.silence(t35(baud_) - wire_.character() - kClock);
  wire_.byte(0x55);
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::BadCheck});
}

TEST_P(RtuGaps, AFrameWithARightCrcIsOverAtT35ThoughAByteIsComingIn) {
  wire_.bytes(kChannel0On);
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.byte(0x55);
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::Accepted, Verdict::TooShort}));
}

// D11 knows one exception to "over after 3.5 characters", and a right CRC is not it; who serves which
// interrupt first must not matter.
TEST_P(RtuGaps, AFrameWithARightCrcIsOverAtT35ThoughAByteIsComingInAndTheTimerIsLate) {
  wire_.timer_works = false;
  wire_.bytes(kChannel0On);
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.byte(0x55);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
  wire_.timer_works = true;
  wire_.rest();
  EXPECT_EQ(wire_.verdicts, (Verdicts{Verdict::Accepted, Verdict::TooShort}));
}

TEST_P(RtuGaps, AWrongCrcAtT35WaitsForAByteThatMayBeComingIn) {
  wire_.bytes({0x01, 0x05, 0x00});
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Open);
  EXPECT_TRUE(assembler_.wants_more_silence());
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::TooShort);
  EXPECT_FALSE(assembler_.wants_more_silence());
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Open);
}

TEST_P(RtuGaps, AByteThatStartedBeforeT35ContinuesALapsedFrame) {
  wire_.bytes({0x01, 0x05, 0x00});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.byte(0x00);
  EXPECT_TRUE(wire_.verdicts.empty());
  EXPECT_FALSE(assembler_.wants_more_silence());
  wire_.frame({0xFF, 0x00, 0x8C, 0x3A});
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, AFrameMayLapseMoreThanOnce) {
  wire_.bytes({0x01, 0x05, 0x00});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.bytes({0x00, 0xFF});
  wire_.silence(t35(baud_) - wire_.character() / 2);
  wire_.frame({0x00, 0x8C, 0x3A});
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, ARightCrcAtT35IsAcceptedAtOnce) {
  wire_.bytes(kChannel0On);
  EXPECT_EQ(assembler_.silence(kOwn, wire_.time() + kLongSilence), Verdict::Accepted);
  EXPECT_FALSE(assembler_.wants_more_silence());
}

TEST_P(RtuGaps, AFrameAcrossTheWrapOfTheClockIsOneFrame) {
  for (const std::uint32_t before : {1U, 100U, 3000U, 9000U, 40'000U}) {
    wire_.verdicts.clear();
    wire_.start_at(Time(0U - before));
    with_gap(kChannel0On, 4, t35(baud_) - kClock);
    EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted}) << before;
  }
}

TEST_P(RtuGaps, StrictlyAGapLongerThanT15SpoilsTheFrame) {
  assembler_.use(LineTiming::at(baud_), InterCharacterGap::Refused);
  for (std::size_t split = 1; split < kChannel0On.size(); ++split) {
    wire_.verdicts.clear();
    with_gap(kChannel0On, split, t15(baud_) + kClock);
    ASSERT_EQ(wire_.verdicts.size(), 1U) << "behind byte " << split;
    EXPECT_NE(wire_.verdicts.front(), Verdict::Accepted) << "behind byte " << split;
  }
  EXPECT_TRUE(wire_.frames.empty());
}

TEST_P(RtuGaps, StrictlyAGapOfT15IsAllowed) {
  assembler_.use(LineTiming::at(baud_), InterCharacterGap::Refused);
  for (std::size_t split = 1; split < kChannel0On.size(); ++split) {
    wire_.verdicts.clear();
    with_gap(kChannel0On, split, t15(baud_));
    EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted}) << "behind byte " << split;
  }
}

TEST_P(RtuGaps, StrictlyAFrameWithoutGapsBehindASpoiledOneIsAccepted) {
  assembler_.use(LineTiming::at(baud_), InterCharacterGap::Refused);
  with_gap(kChannel0On, 4, t15(baud_) + kClock);
  wire_.verdicts.clear();
  wire_.frame(kChannel0On);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

TEST_P(RtuGaps, StrictlyAGapShorterThanT35StillDoesNotEndAFrame) {
  assembler_.use(LineTiming::at(baud_), InterCharacterGap::Refused);
  with_gap(frame_of(20), 12, t35(baud_) - kClock);
  EXPECT_EQ(wire_.verdicts.size(), 1U);
  EXPECT_TRUE(wire_.frames.empty());
}

// The gap is refused inside a frame, and the frame is judged without the 00.
TEST_P(RtuGaps, StrictlyAGapBehindATurnAround00DoesNotSpoilTheFrame) {
  assembler_.use(LineTiming::at(baud_), InterCharacterGap::Refused);
  with_gap(behind(0x00, kChannel0On), 1, t15(baud_) + kClock);
  EXPECT_EQ(wire_.verdicts, Verdicts{Verdict::Accepted});
}

}  // namespace
}  // namespace ex9000
