// A file that describes lines and their modules.
#pragma once

#include <string>

#include "sim/setup.hpp"

namespace ex9000::sim {

/// Whether an argument names a bus file: it ends with .json.
bool is_bus_file(const std::string& argument);

/// Throws std::invalid_argument, one line, `PATH:LINE: KEY: what is wrong and the mend`.
Setup read_bus_file(const std::string& path);
/// Likewise, of what stands in it.
Setup parse_bus_file(const std::string& path, const std::string& text);

/// A bus file that shows all that one may hold.
std::string example_bus_file();

}  // namespace ex9000::sim
