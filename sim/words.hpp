// A line of text as words.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace ex9000::sim {

using Words = std::vector<std::string>;

/// What stands between blanks.
inline Words words_of(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

}  // namespace ex9000::sim
