// The form of a command, as people read it and as the program checks it.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "sim/text/fail.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

/// `shape`: for example `pulse C [xCOUNT]` or `fault FAULT...`.
inline bool is_shape_of(std::string_view shape, std::string_view name) {
  return shape.substr(0, shape.find(' ')) == name;
}

/// A word of the shape is one argument, in brackets if it may be missing; with `...`, all the rest.
inline void check_shape(std::string_view shape, const Words& args, const std::string& lead = "expected ") {
  const Words known = words_of(std::string(shape));
  const auto may_be_missing = [](const std::string& word) { return word[0] == '['; };
  const auto missing = std::count_if(known.begin(), known.end(), may_be_missing);
  const bool takes_rest = shape.find("...") != std::string_view::npos;
  if (args.size() + 1 + static_cast<std::size_t>(missing) < known.size() ||
      (!takes_rest && args.size() + 1 > known.size())) {
    fail(lead + std::string(shape));
  }
}

}  // namespace ex9000::sim
