// Formats a value as YAML in block style.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace ex9000::sim {

/// Objects keep their order. Keys must be plain words. Strings that YAML could read as another type are
/// quoted. Empty objects and arrays become `{}` and `[]`. The result ends with a newline.
std::string yaml_of(const nlohmann::ordered_json& value);

}  // namespace ex9000::sim
