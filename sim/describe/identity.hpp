// Identifiers of a model for other tools.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Returns an id that every tool accepts, for example `ex9042d_m`.
inline std::string model_key(const Model& model) {
  std::string key;
  for (const char character : model.designation) {
    const bool upper = character >= 'A' && character <= 'Z';
    key += character == '-' ? '_' : static_cast<char>(upper ? character - 'A' + 'a' : character);
  }
  return key;
}

}  // namespace ex9000::sim
