// Reads a notation word by word.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "sim/text/fail.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

class WordReader {
 public:
  explicit WordReader(Words words) : words_(std::move(words)) {}

  [[nodiscard]] bool done() const { return at_ == words_.size(); }

  /// `wanted`: for the message if no word is left.
  std::string next(const std::string& wanted) {
    if (done()) {
      fail("ends too early; expected " + wanted);
    }
    return words_[at_++];
  }

  void expect(const std::string& wanted) {
    const std::string word = next("'" + wanted + "'");
    if (word != wanted) {
      fail("'" + word + "': expected '" + wanted + "'");
    }
  }

 private:
  Words words_;
  std::size_t at_ = 0;
};

}  // namespace ex9000::sim
