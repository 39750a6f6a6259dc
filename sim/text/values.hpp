// Values as people write them on the command line, in bus files, on the control socket, in faults and in
// transcripts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/line_format.hpp"

namespace ex9000::sim {

// Each parser requires that the whole text is a value of the described form. For any other text, the
// functions whose names begin with `parse` throw std::invalid_argument with a one-line message, for example
// `'maybe': expected on or off`.

bool parse_on_off(const std::string& text);
inline std::string on_off_text(bool on) { return on ? "on" : "off"; }
/// Parses one of two words; returns true for `yes`.
bool parse_choice(const std::string& text, std::string_view yes, std::string_view no);
/// Parses decimal digits; the value must be from `least` to `most`.
std::uint64_t parse_whole_number(const std::string& text, std::uint64_t least, std::uint64_t most);
/// Parses a decimal number from `least` to `most`, with or without a fraction and an exponent; returns
/// nullopt for any other text.
std::optional<double> decimal_number(const std::string& text, double least, double most);
/// Parses a number above 0 and up to 1.
double parse_probability(const std::string& text);
/// Parses 8N1, 8N2, 8E1 or 8O1.
LineFormat parse_line_format(const std::string& text);
/// Returns the name that `parse_line_format` reads.
std::string line_format_text(LineFormat format);
/// Returns a rate and a format for people, for example `9600 baud 8N1`.
std::string mode_text(std::uint32_t baud, LineFormat format);
/// Parses one of kBaudRates, in bits per second.
std::uint32_t parse_baud_rate(const std::string& text);
/// Parses one or two hex digits, in upper or lower case.
std::uint8_t parse_hex_byte(const std::string& text);
/// Parses one to four hex digits, in upper or lower case.
std::uint16_t parse_hex_word(const std::string& text);
/// Parses one or more pairs of hex digits, in upper or lower case. Ignores blanks and tabs.
std::vector<std::uint8_t> parse_hex_bytes(const std::string& text);

/// Parses decimal digits with a value from 0 to `most`; returns nullopt for any other text.
std::optional<std::uint64_t> whole_number(const std::string& text, std::uint64_t most);

/// Returns the lowest 8 bits as two upper-case hex digits.
std::string hex_byte_text(unsigned value);
/// Returns the lowest 16 bits as four upper-case hex digits.
std::string hex_word_text(unsigned value);
/// Returns each byte as two upper-case hex digits, with `separator` between the bytes.
std::string hex_text(const std::vector<std::uint8_t>& bytes, std::string_view separator = "");

}  // namespace ex9000::sim
