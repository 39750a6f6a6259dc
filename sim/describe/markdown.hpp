// The commands and registers, for people: made from the tables that the module itself works by.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Of all models, for a section of README.md.
std::string markdown_of_all();

/// Of what this model has, and of nothing else.
std::string markdown_of(const Model& model);

}  // namespace ex9000::sim
