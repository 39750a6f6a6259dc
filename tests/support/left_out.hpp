// What `tests/run --without NAME` leaves out.
#pragma once

#include <cstdlib>
#include <sstream>
#include <string>

namespace ex9000::system {

/// Returns whether the environment variable EX9000_WITHOUT contains `name`. The variable is a list of names,
/// separated by spaces.
inline bool without(const std::string& name) {
  const char* const names = std::getenv("EX9000_WITHOUT");
  std::istringstream left_out(names == nullptr ? "" : names);
  for (std::string each; left_out >> each;) {
    if (each == name) {
      return true;
    }
  }
  return false;
}

}  // namespace ex9000::system
