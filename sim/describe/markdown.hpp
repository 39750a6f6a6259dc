// The commands and registers as Markdown, for people. The text is made from the tables that the firmware
// itself uses.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Describes all models, for a section of README.md.
std::string markdown_of_all();

/// Describes only this model.
std::string markdown_of(const Model& model);

}  // namespace ex9000::sim
