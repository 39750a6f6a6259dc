// Tests the states of the DCON assembler, and framing: wire.md section 3, "The receiver" and "Judging a
// frame", rule 1.
#include "firmware/line/dcon_assembler.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "tests/firmware/line/dcon_bench.hpp"

namespace ex9000 {
namespace {

constexpr std::string_view kDelimiters = "#$%@~";
/// The first characters of replies.
constexpr std::string_view kLeads = "!>?";

// --- waiting for a delimiter ---

TEST_F(DconAssemblerTest, EveryDelimiterOpensAFrame) {
  for (const char delimiter : kDelimiters) {
    const std::string text = std::string(1, delimiter) + "016";
    EXPECT_EQ(put(text + "\r"), Verdict::Accepted) << delimiter;
    EXPECT_EQ(taken(), text);
  }
}

TEST_F(DconAssemblerTest, TheCarriageReturnCompletesAFrame) {
  put("$01M");
  EXPECT_FALSE(queue_.has_frame());
  put('\r');
  ASSERT_TRUE(queue_.has_frame());
  EXPECT_EQ(queue_.waiting().received.microseconds(), now_.microseconds());
}

TEST_F(DconAssemblerTest, ACarriageReturnBetweenFramesChangesNothing) {
  EXPECT_EQ(put("\r"), Verdict::Open);
  EXPECT_EQ(put("\r"), Verdict::Open);
  expect_hunting();
}

TEST_F(DconAssemblerTest, BetweenFramesAllCharactersExceptDelimitersAndLeadsAreIgnored) {
  for (int character = 0; character < 256; ++character) {
    const char noise = static_cast<char>(character);
    if (kDelimiters.find(noise) != std::string_view::npos || kLeads.find(noise) != std::string_view::npos) {
      continue;
    }
    EXPECT_EQ(put(noise), Verdict::Open) << character;
    EXPECT_EQ(put("$012\r"), Verdict::Accepted) << character;
    EXPECT_EQ(taken(), "$012") << character;
  }
}

TEST_F(DconAssemblerTest, ALineFeedAndATurnAround00BetweenFramesAreIgnored) {
  EXPECT_EQ(put("$012\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "$012");
  EXPECT_EQ(put(std::string_view("\n\0$01M\r", 7)), Verdict::Accepted);
  EXPECT_EQ(taken(), "$01M");
}

TEST_F(DconAssemblerTest, ADelimiterWithALineErrorOpensNoFrame) {
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break, ByteStatus::Overrun}) {
    EXPECT_EQ(put('$', status), Verdict::Open);
    EXPECT_EQ(put("01M\r"), Verdict::Open);
    EXPECT_EQ(taken(), "nothing");
    expect_hunting();
  }
}

TEST_F(DconAssemblerTest, ALeadWithALineErrorIsIgnored) {
  for (const char lead : kLeads) {
    EXPECT_EQ(put(lead, ByteStatus::FramingError), Verdict::Open);
    expect_hunting();
  }
}

TEST_F(DconAssemblerTest, BetweenFramesACharacterWithALineErrorIsIgnored) {
  EXPECT_EQ(put('\0', ByteStatus::Break), Verdict::Open);
  EXPECT_EQ(put('\r', ByteStatus::FramingError), Verdict::Open);
  expect_hunting();
}

// --- in a frame ---

TEST_F(DconAssemblerTest, DelimitersAndLeadsAreContentWithinAFrame) {
  EXPECT_EQ(put("~01O$#%@~!\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "~01O$#%@~!");
  EXPECT_EQ(put("~01O?>!\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "~01O?>!");
}

TEST_F(DconAssemblerTest, EveryCharacterExceptCarriageReturnIsContentWithinAFrame) {
  for (int character = 0; character < 256; ++character) {
    if (character == '\r') {
      continue;
    }
    const std::string text = std::string("$01") + static_cast<char>(character);
    EXPECT_EQ(put(text + "\r"), Verdict::Accepted) << character;
    EXPECT_EQ(taken(), text) << character;
  }
}

TEST_F(DconAssemblerTest, ASecondDelimiterDoesNotStartANewFrame) {
  EXPECT_EQ(put("$02$01M\r"), Verdict::Foreign);
  expect_hunting();
}

TEST_F(DconAssemblerTest, ThereIsNoTimeoutBetweenCharacters) {
  put("$0");
  now_ = now_ + milliseconds(3'600'000);
  EXPECT_EQ(put("1M\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "$01M");
}

TEST_F(DconAssemblerTest, ALineErrorWithinAFrameSpoilsItUpToTheNextCarriageReturn) {
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break, ByteStatus::Overrun}) {
    put("$0");
    EXPECT_EQ(put('1', status), Verdict::Open);
    EXPECT_EQ(put("M$01M\r"), status == ByteStatus::Overrun ? Verdict::Overrun : Verdict::LineError);
    EXPECT_EQ(taken(), "nothing");
    expect_hunting();
  }
}

TEST_F(DconAssemblerTest, ALineErrorInAnyCharacterAfterTheDelimiterSpoilsTheFrame) {
  constexpr std::string_view kFrame = "$01M";
  for (std::size_t errored = 1; errored < kFrame.size(); ++errored) {
    for (std::size_t i = 0; i < kFrame.size(); ++i) {
      put(kFrame[i], i == errored ? ByteStatus::FramingError : ByteStatus::Good);
    }
    EXPECT_EQ(put('\r'), Verdict::LineError) << "error at " << errored;
    EXPECT_EQ(taken(), "nothing");
  }
}

TEST_F(DconAssemblerTest, ACarriageReturnWithALineErrorSpoilsTheFrameAndDoesNotEndIt) {
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break, ByteStatus::Overrun}) {
    put("$01M");
    EXPECT_EQ(put('\r', status), Verdict::Open);
    EXPECT_EQ(put("$01M\r"), status == ByteStatus::Overrun ? Verdict::Overrun : Verdict::LineError);
    EXPECT_EQ(taken(), "nothing");
    expect_hunting();
  }
}

TEST_F(DconAssemblerTest, ADelimiterWithALineErrorWithinAFrameSpoilsTheFrame) {
  put("$01");
  EXPECT_EQ(put('$', ByteStatus::FramingError), Verdict::Open);
  EXPECT_EQ(put("01M\r"), Verdict::LineError);
  expect_hunting();
}

TEST_F(DconAssemblerTest, ASpoiledFrameStaysSpoiledUntilTheCarriageReturn) {
  put("$0");
  put('1', ByteStatus::Break);
  EXPECT_EQ(put('\r', ByteStatus::FramingError), Verdict::Open);
  EXPECT_EQ(put(std::string(100, '$')), Verdict::Open);
  EXPECT_EQ(put('#', ByteStatus::Overrun), Verdict::Open);
  EXPECT_EQ(put('\r'), Verdict::LineError);
  expect_hunting();
}

// --- skipping another module's reply ---

TEST_F(DconAssemblerTest, AReplyIsSkippedFromAnyLeadToTheCarriageReturn) {
  for (const char lead : kLeads) {
    EXPECT_EQ(put(std::string(1, lead) + "02$01M\r"), Verdict::Open) << lead;
    EXPECT_EQ(taken(), "nothing");
    expect_hunting();
  }
}

TEST_F(DconAssemblerTest, AReplyWithAllDelimitersAndLeadsIsSkippedWhole) {
  EXPECT_EQ(put("!02#$%@~!>?$01M~**\r"), Verdict::Open);
  EXPECT_EQ(taken(), "nothing");
  expect_hunting();
}

TEST_F(DconAssemblerTest, ALongReplyIsSkippedWhole) {
  EXPECT_EQ(put("!" + std::string(1000, '$') + "\r"), Verdict::Open);
  expect_hunting();
}

TEST_F(DconAssemblerTest, ALineErrorWithinASkippedReplyIsIgnored) {
  put("!02");
  EXPECT_EQ(put('$', ByteStatus::FramingError), Verdict::Open);
  EXPECT_EQ(put("01M\r"), Verdict::Open);
  expect_hunting();
}

TEST_F(DconAssemblerTest, ACarriageReturnWithALineErrorDoesNotEndASkippedReply) {
  put("!02");
  EXPECT_EQ(put('\r', ByteStatus::FramingError), Verdict::Open);
  EXPECT_EQ(put("$01M\r"), Verdict::Open);
  EXPECT_EQ(taken(), "nothing");
  expect_hunting();
}

TEST_F(DconAssemblerTest, AReplyAfterNoiseIsSkipped) {
  EXPECT_EQ(put("\nX!02$01M\r"), Verdict::Open);
  EXPECT_EQ(taken(), "nothing");
  expect_hunting();
}

// --- length ---

TEST_F(DconAssemblerTest, AFrameShorterThanDelimiterAndAddressIsDropped) {
  for (const char* text : {"$\r", "$0\r", "~*\r", "#\r"}) {
    EXPECT_EQ(put(text), Verdict::Foreign) << text;
    EXPECT_EQ(taken(), "nothing");
  }
  expect_hunting();
}

TEST_F(DconAssemblerTest, AFrameOfDelimiterAndAddressIsAccepted) {
  EXPECT_EQ(put("@01\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "@01");
}

TEST_F(DconAssemblerTest, AFrameOf32CharactersIsAccepted) {
  EXPECT_EQ(put(frame_of(32) + "\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), frame_of(32));
}

TEST_F(DconAssemblerTest, AFrameLongerThan32CharactersIsDroppedAndTheNextFrameIsAccepted) {
  for (const std::size_t characters : {33U, 34U, 64U, 255U, 256U, 257U, 1000U}) {
    EXPECT_EQ(put(frame_of(characters) + "\r"), Verdict::TooLong) << characters;
    EXPECT_EQ(taken(), "nothing");
    expect_hunting();
  }
}

TEST_F(DconAssemblerTest, ALineErrorInCharacter32Or33SpoilsTheFrame) {
  for (const std::size_t good : {31U, 32U}) {
    put(frame_of(good));
    put('X', ByteStatus::FramingError);
    EXPECT_NE(put('\r'), Verdict::Accepted);
    EXPECT_EQ(taken(), "nothing");
    expect_hunting();
  }
}

// --- queue space ---

TEST_F(DconAssemblerTest, AFrameIsAssembledWhileAnotherFrameWaits) {
  EXPECT_EQ(put("$01M\r"), Verdict::Accepted);
  EXPECT_EQ(put("$012"), Verdict::Open);
  EXPECT_EQ(taken(), "$01M");
  EXPECT_EQ(put('\r'), Verdict::Accepted);
  EXPECT_EQ(taken(), "$012");
}

TEST_F(DconAssemblerTest, AFrameThatEndsWhileAnotherWaitsIsDropped) {
  EXPECT_EQ(put("$01M\r"), Verdict::Accepted);
  EXPECT_EQ(put("$012\r"), Verdict::NoRoom);
  EXPECT_EQ(taken(), "$01M");
  EXPECT_EQ(taken(), "nothing");
  expect_hunting();
}

TEST_F(DconAssemblerTest, AHostOkIsRecognisedWhileTheQueueIsFull) {
  EXPECT_EQ(put("$01M\r"), Verdict::Accepted);
  EXPECT_EQ(put("~**\r"), Verdict::HostOk);
  EXPECT_EQ(put("~**\r"), Verdict::HostOk);
  EXPECT_EQ(taken(), "$01M");
}

TEST_F(DconAssemblerTest, AForeignFrameIsRecognisedWhileTheQueueIsFull) {
  EXPECT_EQ(put("$01M\r"), Verdict::Accepted);
  EXPECT_EQ(put("$02M\r"), Verdict::Foreign);
  EXPECT_EQ(taken(), "$01M");
}

// --- discarding a frame (`forget`) ---

TEST_F(DconAssemblerTest, AnOpenFrameCanBeDiscarded) {
  put("$01");
  assembler_.forget();
  EXPECT_EQ(put("M\r"), Verdict::Open);
  EXPECT_EQ(taken(), "nothing");
  expect_hunting();
}

TEST_F(DconAssemblerTest, ASpoiledFrameCanBeDiscarded) {
  put("$01");
  put('X', ByteStatus::Break);
  assembler_.forget();
  expect_hunting();
}

TEST_F(DconAssemblerTest, ATooLongFrameCanBeDiscarded) {
  put(frame_of(40));
  assembler_.forget();
  expect_hunting();
}

TEST_F(DconAssemblerTest, ADiscardedFrameDoesNotAffectTheNextChecksum) {
  assembler_.use_checksum(true);
  put("$01XYZ");
  assembler_.forget();
  EXPECT_EQ(put("$012B7\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "$012");
}

TEST_F(DconAssemblerTest, DiscardingTheOpenFrameKeepsTheWaitingFrame) {
  EXPECT_EQ(put("$01M\r"), Verdict::Accepted);
  assembler_.forget();
  EXPECT_EQ(taken(), "$01M");
}

}  // namespace
}  // namespace ex9000
