// Returns the reason why a parser rejects its input.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::sim {

/// Returns the message of the std::invalid_argument that `parse` throws, or "accepted" if it throws nothing.
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
