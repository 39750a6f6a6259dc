// How a program reports that it cannot do what the user wants.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace ex9000::sim {

/// The exit status if an argument is wrong.
constexpr int kWrongArguments = 2;

/// Control characters become blanks, but not at the end: an error is one line, and may quote newlines.
inline std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char character) { return std::iscntrl(character) != 0; }, ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace ex9000::sim
