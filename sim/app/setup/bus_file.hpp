// A bus file: YAML, or JSON, that describes lines and their modules.
#pragma once

#include <string>

#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// Returns whether an argument names a bus file: it ends with .yaml, .yml or .json, has other characters
/// before that, and is not MODEL[@ADDR],KEY=VALUE, whose last value may be such a path. With a `/` before its
/// first comma, such a path names a bus file too.
bool is_bus_file(const std::string& argument);

/// Reads a bus file. Throws std::invalid_argument with a one-line message, `PATH:LINE: KEY: TEXT`, without
/// LINE and KEY if the file cannot be read.
Setup read_bus_file(const std::string& path);
/// Parses `text` as the content of the file `path`. Throws like read_bus_file.
Setup parse_bus_file(const std::string& path, const std::string& text);

/// Returns app/setup/example.yaml.
std::string example_bus_file();

}  // namespace ex9000::sim
