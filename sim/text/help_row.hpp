// How texts for help are laid out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "sim/text/words.hpp"

namespace ex9000::sim {

/// `does` begins at `column`, on the next line if the shape is too long.
inline std::string help_row(const std::string& shape, std::string_view does, std::size_t column) {
  const std::string indent(column + 2, ' ');
  std::string lead = "  " + shape;
  lead.resize(std::max(lead.size(), indent.size()), ' ');
  lead += lead.back() == ' ' ? "" : "\n" + indent;
  std::string text;
  for (const std::string& line : parts_of(std::string(does), '\n')) {
    text += lead;
    text += line;
    text += '\n';
    lead = indent;
  }
  return text;
}

}  // namespace ex9000::sim
