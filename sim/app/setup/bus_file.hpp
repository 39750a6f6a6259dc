// A bus file: YAML, or JSON, that describes lines and their modules.
#pragma once

#include <string>

#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// It ends with .yaml, .yml or .json after other characters, and is not MODEL[@ADDR],KEY=VALUE, whose last
/// value may be such a path; with a `/` before its first comma, it is a bus file too.
bool is_bus_file(const std::string& argument);

/// Errors: `PATH:LINE: KEY: TEXT`, without LINE and KEY if the file cannot be read.
Setup read_bus_file(const std::string& path);
/// As the content of the file `path`.
Setup parse_bus_file(const std::string& path, const std::string& text);

/// It is app/setup/example.yaml.
std::string example_bus_file();

}  // namespace ex9000::sim
