// The commands and registers as Markdown, for people. The text is generated from the firmware's tables.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Describes all models, for firmware/registers.md.
std::string markdown_of_all();

/// Describes only this model.
std::string markdown_of(const Model& model);

}  // namespace ex9000::sim
