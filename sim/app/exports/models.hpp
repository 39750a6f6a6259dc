// The models that a description covers: one, or all.
#pragma once

#include <algorithm>
#include <vector>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// The list is never empty.
using Models = std::vector<const Model*>;

inline Models all_models() {
  Models models;
  for (const Model& model : kModels) {
    models.push_back(&model);
  }
  return models;
}

template <class Has>
bool any_has(const Models& models, Has has) {
  return std::any_of(models.begin(), models.end(), [&](const Model* model) { return has(*model); });
}

}  // namespace ex9000::sim
