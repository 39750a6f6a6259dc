// Tests checksum, address and broadcasts of DCON frames: wire.md section 3, "Judging a frame", rules 2 to 4.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "firmware/line/dcon_assembler.hpp"
#include "tests/firmware/line/dcon_bench.hpp"

namespace ex9000 {
namespace {

/// Returns `text` with the checksum of wire.md section 3, which is computed without the firmware's code.
std::string with_checksum(std::string text) {
  unsigned sum = 0;
  for (const char character : text) {
    sum += static_cast<unsigned char>(character);
  }
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  text += kDigits[sum / 16 % 16];
  text += kDigits[sum % 16];
  return text;
}

// --- the checksum ---

TEST_F(DconAssemblerTest, ACorrectChecksumIsRemoved) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put("$012B7\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "$012");
}

TEST_F(DconAssemblerTest, TheSumIsTakenModulo256) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put(with_checksum("~01O~~~~~~") + "\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "~01O~~~~~~");
}

TEST_F(DconAssemblerTest, AFrameWithAWrongChecksumIsDropped) {
  assembler_.use_checksum(true);
  for (const char* text : {"$012B8\r", "$012C7\r", "$01200\r", "$0127B\r"}) {
    EXPECT_EQ(put(text), Verdict::BadCheck) << text;
    EXPECT_EQ(taken(), "nothing");
  }
}

TEST_F(DconAssemblerTest, AChecksumThatIsNotTwoUpperCaseHexDigitsIsWrong) {
  assembler_.use_checksum(true);
  for (const char* text : {"$012b7\r", "$012 7\r", "$012B:\r"}) {
    EXPECT_EQ(put(text), Verdict::BadCheck) << text;
  }
}

TEST_F(DconAssemblerTest, AFrameWithoutAChecksumIsDropped) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put("$0120\r"), Verdict::BadCheck);
  EXPECT_NE(put("$012\r"), Verdict::Accepted);
  EXPECT_NE(put("@01\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "nothing");
}

TEST_F(DconAssemblerTest, AFrameOfDelimiterAddressAndChecksumIsAccepted) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put(with_checksum("@01") + "\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "@01");
}

TEST_F(DconAssemblerTest, AFrameTooShortForAnAddressIsDroppedEvenWithACorrectChecksum) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put(with_checksum("$0") + "\r"), Verdict::Foreign);
  EXPECT_EQ(put(with_checksum("$") + "\r"), Verdict::Foreign);
}

TEST_F(DconAssemblerTest, ChecksumCharactersAreContentIfTheChecksumIsDisabled) {
  EXPECT_EQ(put("$012B7\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "$012B7");
}

TEST_F(DconAssemblerTest, TheChecksumIsCheckedBeforeTheAddress) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put("$022B7\r"), Verdict::BadCheck);
  EXPECT_EQ(put("$022B8\r"), Verdict::Foreign);
}

TEST_F(DconAssemblerTest, TheLimitOf32CharactersIncludesTheChecksum) {
  assembler_.use_checksum(true);
  const std::string longest = with_checksum(frame_of(30));
  ASSERT_EQ(longest.size(), 32U);
  EXPECT_EQ(put(longest + "\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), frame_of(30));
  EXPECT_EQ(put(with_checksum(frame_of(31)) + "\r"), Verdict::TooLong);
  EXPECT_EQ(taken(), "nothing");
}

// --- address and broadcasts ---

TEST_F(DconAssemblerTest, AnotherAddressIsForeign) {
  for (const char* text : {"$02M\r", "$00M\r", "$FFM\r", "$10M\r"}) {
    EXPECT_EQ(put(text), Verdict::Foreign) << text;
    EXPECT_EQ(taken(), "nothing");
  }
}

TEST_F(DconAssemblerTest, AnAddressThatIsNotTwoHexDigitsIsForeign) {
  for (const char* text : {"$G1M\r", "$ 1M\r", "$1 M\r", "$0*M\r", "$*1M\r"}) {
    EXPECT_EQ(put(text), Verdict::Foreign) << text;
  }
}

TEST_F(DconAssemblerTest, AnAddressInLowerCaseIsForeign) {
  own_ = 0xAB;
  EXPECT_EQ(put("$abM\r"), Verdict::Foreign);
  EXPECT_EQ(put("$aBM\r"), Verdict::Foreign);
  EXPECT_EQ(put("$ABM\r"), Verdict::Accepted);
}

TEST_F(DconAssemblerTest, EveryAddressCanBeTheAddressOfTheModule) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (unsigned address = 0; address < 256; ++address) {
    own_ = static_cast<std::uint8_t>(address);
    const std::string text = std::string("$") + kDigits[address / 16] + kDigits[address % 16] + "M";
    EXPECT_EQ(put(text + "\r"), Verdict::Accepted) << address;
    EXPECT_EQ(taken(), text);
  }
}

TEST_F(DconAssemblerTest, AChangedAddressAppliesToTheOpenFrame) {
  put("$02M");
  own_ = 0x02;
  EXPECT_EQ(put('\r'), Verdict::Accepted);
}

TEST_F(DconAssemblerTest, TheSampleBroadcastIsAccepted) {
  EXPECT_EQ(put("#**\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "#**");
}

TEST_F(DconAssemblerTest, TheHostOkBroadcastIsRecognisedAndNotQueued) {
  EXPECT_EQ(put("~**\r"), Verdict::HostOk);
  EXPECT_EQ(taken(), "nothing");
  expect_hunting();
}

TEST_F(DconAssemblerTest, BroadcastsCarryTheChecksumToo) {
  assembler_.use_checksum(true);
  EXPECT_EQ(put("#**77\r"), Verdict::Accepted);
  EXPECT_EQ(taken(), "#**");
  EXPECT_EQ(put("~**D2\r"), Verdict::HostOk);
}

TEST_F(DconAssemblerTest, ABroadcastWithAMissingOrWrongChecksumIsDropped) {
  assembler_.use_checksum(true);
  EXPECT_NE(put("~**\r"), Verdict::HostOk);
  EXPECT_EQ(put("~**D3\r"), Verdict::BadCheck);
  EXPECT_NE(put("#**\r"), Verdict::Accepted);
  EXPECT_EQ(put("#**78\r"), Verdict::BadCheck);
  EXPECT_EQ(taken(), "nothing");
}

TEST_F(DconAssemblerTest, ABroadcastWithAChecksumIsIgnoredIfTheChecksumIsDisabled) {
  EXPECT_EQ(put("~**D2\r"), Verdict::Ignored);
  EXPECT_EQ(put("#**77\r"), Verdict::Ignored);
  EXPECT_EQ(taken(), "nothing");
}

TEST_F(DconAssemblerTest, OtherFramesWithABroadcastAddressAreIgnored) {
  for (const char* text : {"$**\r", "%**\r", "@**\r", "$**M\r", "@**FF\r", "#**0\r", "~**0\r"}) {
    EXPECT_EQ(put(text), Verdict::Ignored) << text;
    EXPECT_EQ(taken(), "nothing");
  }
}

}  // namespace
}  // namespace ex9000
