// Opens files that the user names.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace ex9000::sim {

/// Opens a regular file for reading. Returns a stream that is not open if `path` is not a regular file or is
/// not readable. Does not open a pipe, because opening a pipe may block. Does not open a device, because a
/// device may deliver bytes without end.
inline std::ifstream open_regular_file(const std::string& path) {
  std::ifstream file;
  std::error_code unknown;
  if (std::filesystem::is_regular_file(path, unknown)) {
    file.open(path, std::ios::binary);
  }
  return file;
}

}  // namespace ex9000::sim
