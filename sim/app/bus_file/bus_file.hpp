// A bus file: JSON that describes lines and their modules.
#pragma once

#include <string>

#include "sim/app/run_setup/setup.hpp"

namespace ex9000::sim {

/// Returns whether an argument names a bus file, that is, ends with `.json`.
bool is_bus_file(const std::string& argument);

/// Reads and checks a bus file. Throws std::invalid_argument with a one-line message, `PATH:LINE: KEY: what
/// is wrong; what would be right`. The message has no LINE if the file cannot be read, and no KEY if the
/// error does not concern a key.
Setup read_bus_file(const std::string& path);
/// Parses `text` as the content of `path`. Throws like read_bus_file.
Setup parse_bus_file(const std::string& path, const std::string& text);

/// Returns an example of a bus file: two lines with modules, faults, and inputs that change by themselves.
std::string example_bus_file();
/// Returns the JSON Schema of bus files.
std::string bus_file_schema();

}  // namespace ex9000::sim
