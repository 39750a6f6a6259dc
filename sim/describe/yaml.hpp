// A value as YAML in block style.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace ex9000::sim {

/// Objects keep their order. Keys must be plain words. Strings that could be taken for something else are
/// quoted. Empty objects and arrays are `{}` and `[]`. Ends with a newline.
std::string yaml_of(const nlohmann::ordered_json& value);

}  // namespace ex9000::sim
