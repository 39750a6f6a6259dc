// Splits a line of text into words.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace ex9000::sim {

using Words = std::vector<std::string>;

/// Returns the words between blanks.
inline Words words_of(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

/// Returns the words from `first` to `last`, separated by one blank each.
inline std::string joined(Words::const_iterator first, Words::const_iterator last) {
  std::string text;
  for (; first != last; ++first) {
    text += (text.empty() ? "" : " ") + *first;
  }
  return text;
}
inline std::string joined(const Words& words) { return joined(words.begin(), words.end()); }

}  // namespace ex9000::sim
