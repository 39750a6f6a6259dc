// Formats JSON values as YAML.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace ex9000::sim {

/// Returns `value` as YAML in block style. The members of objects keep their order. Keys must be plain words.
/// Strings are quoted if they contain special characters or if YAML could read them as another type. Empty
/// objects and arrays become `{}` and `[]`. The result ends with a newline.
std::string yaml_of(const nlohmann::ordered_json& value);

}  // namespace ex9000::sim
