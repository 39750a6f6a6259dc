// Values as people write them: on the command line, in files, on the control socket, in faults.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/line_format.hpp"

namespace ex9000::sim {

// The whole text must be such a value. For any other, `parse...` throws, for example `'maybe': expected on or
// off`, and the other parsers return nullopt.

bool parse_on_off(const std::string& text);
inline std::string on_off_text(bool on) { return on ? "on" : "off"; }
/// true: `yes`.
bool parse_choice(const std::string& text, std::string_view yes, std::string_view no);
std::uint64_t parse_whole_number(const std::string& text, std::uint64_t least, std::uint64_t most);
/// With or without a fraction and an exponent.
std::optional<double> decimal_number(const std::string& text, double least, double most);
/// Above 0, up to 1.
double parse_probability(const std::string& text);
/// 8N1, 8N2, 8E1 or 8O1.
LineFormat parse_line_format(const std::string& text);
std::string line_format_text(LineFormat format);
/// For example `9600 baud 8N1`.
std::string mode_text(std::uint32_t baud, LineFormat format);
/// One of kBaudRates.
std::uint32_t parse_baud_rate(const std::string& text);
/// Hex digits of either case: one or two; one to four; pairs, where blanks and tabs are ignored.
std::uint8_t parse_hex_byte(const std::string& text);
std::uint16_t parse_hex_word(const std::string& text);
std::vector<std::uint8_t> parse_hex_bytes(const std::string& text);

/// Decimal digits, up to `most`.
std::optional<std::uint64_t> whole_number(const std::string& text, std::uint64_t most);

/// Upper-case hex: two digits for the lowest 8 bits, four for the lowest 16, two for each byte.
std::string hex_byte_text(unsigned value);
std::string hex_word_text(unsigned value);
/// 8 hex digits, for a serial number.
std::string hex_long_text(std::uint32_t value);
std::string hex_text(const std::vector<std::uint8_t>& bytes, std::string_view separator = "");

}  // namespace ex9000::sim
