#include "sim/text/values.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "firmware/hex.hpp"
#include "firmware/model/baud.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kHexDigits = "0123456789ABCDEFabcdef";
/// In the order of LineFormat.
constexpr std::array<std::string_view, 4> kLineFormats{"8N1", "8N2", "8E1", "8O1"};

/// nullopt: not the whole text is a number, or it does not fit the type.
template <class Number, class... Format>
std::optional<Number> number(const std::string& text, Format... format) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value, format...);
  return error == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

[[noreturn]] void expect(const std::string& text, const std::string& expected) {
  fail("'" + text + "': expected " + expected);
}

/// 1 to `most` hex digits. `expected`: for the message.
unsigned parse_hex(const std::string& text, std::size_t most, const std::string& expected) {
  constexpr int kHex = 16;
  const bool digits = text.find_first_not_of(kHexDigits) == std::string::npos && text.size() <= most;
  const auto value = digits ? number<unsigned>(text, kHex) : std::nullopt;
  if (!value) {
    expect(text, expected);
  }
  return *value;
}

}  // namespace

bool parse_on_off(const std::string& text) { return parse_choice(text, "on", "off"); }

bool parse_choice(const std::string& text, std::string_view yes, std::string_view no) {
  if (text != yes && text != no) {
    expect(text, std::string(yes) + " or " + std::string(no));
  }
  return text == yes;
}

std::optional<std::uint64_t> whole_number(const std::string& text, std::uint64_t most) {
  const auto value = number<std::uint64_t>(text);
  return value && *value <= most ? value : std::nullopt;
}

std::uint64_t parse_whole_number(const std::string& text, std::uint64_t least, std::uint64_t most) {
  const auto value = whole_number(text, most);
  if (!value || *value < least) {
    expect(text, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  return *value;
}

std::optional<double> decimal_number(const std::string& text, double least, double most) {
  const auto value = number<double>(text);
  return value && *value >= least && *value <= most ? value : std::nullopt;
}

double parse_probability(const std::string& text) {
  const auto value = decimal_number(text, 0, 1);
  if (!value || *value == 0) {
    expect(text, "a probability above 0 and up to 1, for example 0.01 or 1e-4");
  }
  return *value;
}

LineFormat parse_line_format(const std::string& text) {
  const auto* const found = std::find(kLineFormats.begin(), kLineFormats.end(), text);
  if (found == kLineFormats.end()) {
    expect(text, "a line format: 8N1, 8N2, 8E1 or 8O1");
  }
  return static_cast<LineFormat>(found - kLineFormats.begin());
}

std::string line_format_text(LineFormat format) {
  return std::string(kLineFormats[static_cast<std::size_t>(format)]);
}

std::string mode_text(std::uint32_t baud, LineFormat format) {
  return std::to_string(baud) + " baud " + line_format_text(format);
}

std::uint32_t parse_baud_rate(const std::string& text) {
  std::string rates;
  for (const std::uint32_t rate : kBaudRates) {
    if (text == std::to_string(rate)) {
      return rate;
    }
    const char* const separator = rate == kBaudRates.back() ? " or " : ", ";
    rates += (rates.empty() ? "" : separator) + std::to_string(rate);
  }
  expect(text, "a baud rate: " + rates);
}

std::uint8_t parse_hex_byte(const std::string& text) {
  return static_cast<std::uint8_t>(parse_hex(text, 2, "one or two hex digits"));
}

std::uint16_t parse_hex_word(const std::string& text) {
  constexpr std::size_t kMostDigits = 4;
  return static_cast<std::uint16_t>(parse_hex(text, kMostDigits, "one to four hex digits"));
}

std::vector<std::uint8_t> parse_hex_bytes(const std::string& text) {
  std::string digits = text;
  const auto is_blank = [](char character) { return character == ' ' || character == '\t'; };
  digits.erase(std::remove_if(digits.begin(), digits.end(), is_blank), digits.end());
  if (digits.empty() || digits.size() % 2 != 0 || digits.find_first_not_of(kHexDigits) != std::string::npos) {
    expect(text, "pairs of hex digits, for example 010500FF");
  }
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes.push_back(parse_hex_byte(digits.substr(i, 2)));
  }
  return bytes;
}

std::string hex_byte_text(unsigned value) {
  return {static_cast<char>(hex_digit(value >> 4U)), static_cast<char>(hex_digit(value))};
}

std::string hex_word_text(unsigned value) {
  return hex_byte_text(value >> 8U & 0xFFU) + hex_byte_text(value & 0xFFU);
}

std::string hex_long_text(std::uint32_t value) {
  return hex_word_text(value >> 16U) + hex_word_text(value & 0xFFFFU);
}

std::string hex_text(const std::vector<std::uint8_t>& bytes, std::string_view separator) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += text.empty() ? "" : separator;
    text += hex_byte_text(byte);
  }
  return text;
}

}  // namespace ex9000::sim
