// Upper-case hex digits, as wire.md 3 requires.
#pragma once

#include <optional>
#include <string>

namespace ex9000::reference {

/// Returns the last `digits` hex digits of `value`.
inline std::string hex(unsigned value, std::size_t digits) {
  std::string text;
  for (std::size_t i = 0; i < digits; ++i) {
    text.insert(text.begin(), "0123456789ABCDEF"[value % 16]);
    value /= 16;
  }
  return text;
}

/// Returns the value of the hex digits in `text`, modulo 2^32; no value if `text` is empty or has a character
/// that is not an upper-case hex digit.
inline std::optional<unsigned> number(const std::string& text) {
  if (text.empty() || text.find_first_not_of("0123456789ABCDEF") != std::string::npos) {
    return std::nullopt;
  }
  unsigned value = 0;
  for (const char digit : text) {
    value = value * 16 + static_cast<unsigned>(digit <= '9' ? digit - '0' : digit - 'A' + 10);
  }
  return value;
}

}  // namespace ex9000::reference
