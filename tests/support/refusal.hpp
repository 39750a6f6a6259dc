// Why something is refused.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::sim {

/// What `parse` throws, or a word that it throws nothing.
template <class Parse>
std::string refusal(Parse parse) {
  try {
    parse();
    return "accepted";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

}  // namespace ex9000::sim
