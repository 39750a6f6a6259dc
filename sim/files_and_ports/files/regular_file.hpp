// Opens files that the user names.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

/// Not open unless `path` is a regular file and readable: opening a pipe may block, and a device may deliver
/// bytes without end. Skips the byte-order mark of UTF-8; throws for UTF-16.
inline std::ifstream open_text_file(const std::string& path) {
  std::ifstream file;
  std::error_code unknown;
  if (std::filesystem::is_regular_file(path, unknown)) {
    file.open(path, std::ios::binary);
  }
  std::string first(3, ' ');
  file.read(first.data(), 3);
  const std::string two = first.substr(0, 2);
  const bool half_nul = (two[0] == '\0') != (two[1] == '\0');  // ASCII characters as UTF-16
  if (two == "\xFF\xFE" || two == "\xFE\xFF" || half_nul) {
    fail(path + ": is UTF-16; save it as UTF-8");
  }
  file.clear();
  file.seekg(first == "\xEF\xBB\xBF" ? 3 : 0);
  return file;
}

}  // namespace ex9000::sim
