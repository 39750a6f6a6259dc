// Tests hex digits, which are upper case only (wire.md section 3).
#include "firmware/hex.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace ex9000 {
namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";

std::uint8_t digit(unsigned value) { return static_cast<std::uint8_t>(kDigits[value]); }

TEST(Hex, SixteenDigitsHaveAValue) {
  for (unsigned value = 0; value < kDigits.size(); ++value) {
    EXPECT_EQ(hex_value(digit(value)), static_cast<int>(value));
  }
}

TEST(Hex, ACharacterThatIsNotADigitHasNoValue) {
  for (unsigned character = 0; character < 256; ++character) {
    if (kDigits.find(static_cast<char>(character)) == std::string_view::npos) {
      EXPECT_EQ(hex_value(static_cast<std::uint8_t>(character)), -1) << character;
    }
  }
}

TEST(Hex, ALowerCaseLetterIsNotADigit) {
  for (const char letter : std::string_view("abcdef")) {
    EXPECT_EQ(hex_value(static_cast<std::uint8_t>(letter)), -1) << letter;
  }
}

TEST(Hex, TwoDigitsGiveAByteAndTheFirstIsTheHighDigit) {
  for (unsigned byte = 0; byte < 256; ++byte) {
    EXPECT_EQ(hex_byte(digit(byte / 16), digit(byte % 16)), static_cast<int>(byte));
  }
}

TEST(Hex, TwoCharactersAreNotAByteIfEitherIsNotADigit) {
  EXPECT_EQ(hex_byte('G', '0'), -1);
  EXPECT_EQ(hex_byte('0', 'G'), -1);
  EXPECT_EQ(hex_byte('*', '*'), -1);
  EXPECT_EQ(hex_byte('0', 'a'), -1);
  EXPECT_EQ(hex_byte(' ', '1'), -1);
}

TEST(Hex, EveryValueIsWrittenAsItsDigit) {
  for (unsigned value = 0; value < kDigits.size(); ++value) {
    EXPECT_EQ(hex_digit(value), digit(value));
  }
}

TEST(Hex, OnlyTheLowFourBitsAreWritten) {
  EXPECT_EQ(hex_digit(0x1A), 'A');
  EXPECT_EQ(hex_digit(0xFFF0), '0');
}

}  // namespace
}  // namespace ex9000
