// Compares paths of files that may not exist yet.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace ex9000::sim {

/// Returns the same text for all spellings of `path`. Does not follow a symbolic link at `path` itself.
inline std::string one_spelling(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  const std::filesystem::path folder = std::filesystem::weakly_canonical(absolute.parent_path(), error);
  return (folder / absolute.filename()).string();
}

}  // namespace ex9000::sim
