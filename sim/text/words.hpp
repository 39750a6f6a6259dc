// Splits a line of text into words, and joins words.
#pragma once

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace ex9000::sim {

using Words = std::vector<std::string>;

/// Words are separated by white space.
inline Words words_of(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

/// At least one part; parts may be empty.
inline Words parts_of(const std::string& text, char separator) {
  Words parts(1);
  for (const char character : text) {
    if (character == separator) {
      parts.emplace_back();
    } else {
      parts.back() += character;
    }
  }
  return parts;
}

inline std::string joined(const Words& words, std::string_view separator = " ") {
  std::string text;
  for (const std::string& word : words) {
    text += text.empty() ? "" : separator;
    text += word;
  }
  return text;
}

/// In quotes for the shell, if it needs them.
inline std::string shell_word(const std::string& path) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+:@%";
  if (path.find_first_not_of(plain) == std::string::npos) {
    return path;
  }
  std::string text = "'";
  for (const char character : path) {
    text += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return text + "'";
}

template <class Rows>
std::string names_of(const Rows& rows, std::string_view separator = ", ") {
  Words names;
  for (const auto& row : rows) {
    names.emplace_back(row.name);
  }
  return joined(names, separator);
}

}  // namespace ex9000::sim
