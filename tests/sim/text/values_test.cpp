// Tests the parsing of values that people write, and the text of values that the program writes.
#include "sim/text/values.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "firmware/model/baud.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

/// Expects that `parse` rejects each of `texts` with the message `'TEXT': expected EXPECTED`.
template <class Parse>
void expect_refused(Parse parse, const std::vector<std::string>& texts, const std::string& expected) {
  for (const std::string& text : texts) {
    EXPECT_EQ(refusal([&] { parse(text); }), "'" + text + "': expected " + expected);
  }
}

// --- switches and choices ---

TEST(OnOff, AcceptsOnlyOnAndOffInLowerCase) {
  EXPECT_TRUE(parse_on_off("on"));
  EXPECT_FALSE(parse_on_off("off"));
  expect_refused(parse_on_off, {"maybe", "", "On", "OFF", "on ", " off", "1", "true", "onoff"}, "on or off");
}

TEST(Choice, IsTrueForTheFirstWordAndFalseForTheSecond) {
  const auto parse = [](const std::string& text) { return parse_choice(text, "rising", "falling"); };
  EXPECT_TRUE(parse("rising"));
  EXPECT_FALSE(parse("falling"));
  expect_refused(parse, {"both", "", "Rising", "fall", "falling "}, "rising or falling");
}

// --- whole numbers ---

TEST(WholeNumber, IsWithinItsBounds) {
  EXPECT_EQ(parse_whole_number("3", 3, 15), 3U);
  EXPECT_EQ(parse_whole_number("15", 3, 15), 15U);
  EXPECT_EQ(parse_whole_number("007", 3, 15), 7U);
  EXPECT_EQ(parse_whole_number("0", 0, 0), 0U);
  EXPECT_EQ(parse_whole_number("18446744073709551614", 0, kMost - 1), kMost - 1);
  const auto parse = [](const std::string& text) { return parse_whole_number(text, 3, 15); };
  expect_refused(
      parse,
      {"2", "16", "0", "", " 3", "3 ", "+3", "-3", "3.0", "0x3", "3x", "three", "18446744073709551619"},
      "a whole number from 3 to 15");
}

TEST(WholeNumber, ANumberWithoutAnUpperBoundMayHave64Bits) {
  EXPECT_EQ(parse_whole_number("18446744073709551615", 1, kMost), kMost);
  EXPECT_EQ(parse_whole_number("1", 1, kMost), 1U);
  const auto parse = [](const std::string& text) { return parse_whole_number(text, 1, kMost); };
  expect_refused(parse, {"0", "18446744073709551616", "", "-1", "1e3"},
                 "a whole number from 1 to 18446744073709551615");
}

TEST(WholeNumber, IsNulloptIfTheTextIsNotAWholeNumberUpToTheMaximum) {
  EXPECT_EQ(whole_number("0", 7), 0U);
  EXPECT_EQ(whole_number("7", 7), 7U);
  EXPECT_EQ(whole_number("18446744073709551615", kMost), kMost);
  for (const char* text : {"8", "", "x", "-1", "+1", " 1", "1 ", "1.5", "0x1", "18446744073709551616"}) {
    EXPECT_EQ(whole_number(text, 7), std::nullopt) << text;
  }
}

// --- probabilities ---

TEST(Probability, IsAbove0AndUpTo1) {
  EXPECT_EQ(parse_probability("1"), 1.0);
  EXPECT_EQ(parse_probability("0.01"), 0.01);
  EXPECT_EQ(parse_probability(".5"), 0.5);
  EXPECT_EQ(parse_probability("1e-4"), 1e-4);
  EXPECT_EQ(parse_probability("1e-300"), 1e-300);
  EXPECT_EQ(parse_probability("0.9999999999999999"), 0.9999999999999999);
  expect_refused(parse_probability,
                 {"0", "-0", "1.0000000000000002", "2", "-0.1", "+0.1", "1e-400", "1e400", "nan", "inf", "",
                  "1%", " 1", "1 ", "0,5", "0x1p-1", "often"},
                 "a probability above 0 and up to 1, for example 0.01 or 1e-4");
}

// --- baud rates ---

TEST(BaudRate, AcceptsOnlyRatesThatModulesSupport) {
  for (const std::uint32_t rate : kBaudRates) {
    EXPECT_EQ(parse_baud_rate(std::to_string(rate)), rate);
  }
  expect_refused(parse_baud_rate,
                 {"0", "300", "1199", "1201", "9601", "115201", "230400", "-9600", "+9600", "9600x", "9600.0",
                  " 9600", "9600 ", "", "fast", "4294976896"},  // 2^32 + 9600
                 "a baud rate: 1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
}

// --- hex ---

TEST(HexByte, HasOneOrTwoDigits) {
  EXPECT_EQ(parse_hex_byte("0"), 0x00);
  EXPECT_EQ(parse_hex_byte("a"), 0x0A);
  EXPECT_EQ(parse_hex_byte("0A"), 0x0A);
  EXPECT_EQ(parse_hex_byte("f7"), 0xF7);
  EXPECT_EQ(parse_hex_byte("FF"), 0xFF);
  expect_refused(parse_hex_byte, {"", "100", "001", "G", "1G", "0x", "0x1", "-1", "+1", " 1", "1 ", "1h"},
                 "one or two hex digits");
}

TEST(HexWord, HasOneToFourDigits) {
  EXPECT_EQ(parse_hex_word("0"), 0x0000);
  EXPECT_EQ(parse_hex_word("5"), 0x0005);
  EXPECT_EQ(parse_hex_word("0fF"), 0x00FF);
  EXPECT_EQ(parse_hex_word("FFFF"), 0xFFFF);
  expect_refused(parse_hex_word, {"", "10000", "00000", "G000", "0x01", "-1", "+1", " 1", "1 "},
                 "one to four hex digits");
}

TEST(HexBytes, ArePairsOfDigitsWithOrWithoutBlanks) {
  EXPECT_EQ(parse_hex_bytes("00"), Bytes{0x00});
  EXPECT_EQ(parse_hex_bytes("01 05 00FF"), (Bytes{0x01, 0x05, 0x00, 0xFF}));
  EXPECT_EQ(parse_hex_bytes("05aF00"), (Bytes{0x05, 0xAF, 0x00}));
  EXPECT_EQ(parse_hex_bytes(" 0\t1 "), Bytes{0x01});
  EXPECT_EQ(parse_hex_bytes(std::string(2000, 'F')), Bytes(1000, 0xFF));
  expect_refused(parse_hex_bytes, {"", " \t", "5", "01 0", "0x01", "05G1", "-1", "-1 +1", "01,02", "01\n02"},
                 "pairs of hex digits, for example 010500FF");
}

// --- values that the program writes ---

TEST(HexText, HasTwoOrFourUpperCaseDigitsOfTheLowestBits) {
  EXPECT_EQ(hex_byte_text(0x00), "00");
  EXPECT_EQ(hex_byte_text(0x0A), "0A");
  EXPECT_EQ(hex_byte_text(0xF7), "F7");
  EXPECT_EQ(hex_byte_text(0x1F7), "F7");
  EXPECT_EQ(hex_word_text(0x0000), "0000");
  EXPECT_EQ(hex_word_text(0x0A5F), "0A5F");
  EXPECT_EQ(hex_word_text(0xFFFF), "FFFF");
  EXPECT_EQ(hex_word_text(0x12345), "2345");
}

TEST(HexText, IsReadBackAsTheSameValue) {
  for (unsigned value = 0; value <= 0xFF; ++value) {
    EXPECT_EQ(parse_hex_byte(hex_byte_text(value)), value);
  }
  for (unsigned value = 0; value <= 0xFFFF; value += 0x101) {
    EXPECT_EQ(parse_hex_word(hex_word_text(value)), value);
  }
}

}  // namespace
}  // namespace ex9000::sim
