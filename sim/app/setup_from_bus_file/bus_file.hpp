// A bus file: JSON that describes lines and their modules.
#pragma once

#include <string>

#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// Returns whether an argument names a bus file: it ends with `.json`, has other characters before that, and
/// is not MODEL[@ADDR],KEY=VALUE, whose last value may be a path that ends with `.json`. With a `/` before
/// its first comma, such a path names a bus file too.
bool is_bus_file(const std::string& argument);

/// Reads and checks a bus file. Throws std::invalid_argument with a one-line message, `PATH:LINE: KEY: TEXT`.
/// TEXT says what is wrong or what is expected. The message has neither LINE nor KEY if the file cannot be
/// read. It has no KEY if parse_located (located_json.hpp) rejects the file, or if the file is not an object.
Setup read_bus_file(const std::string& path);
/// Parses and checks `text` as the content of the file `path`. Throws like read_bus_file.
Setup parse_bus_file(const std::string& path, const std::string& text);

/// Returns an example of a bus file: two lines with modules, faults, and inputs that change by themselves.
std::string example_bus_file();
/// Returns the JSON Schema of bus files.
std::string bus_file_schema();

}  // namespace ex9000::sim
