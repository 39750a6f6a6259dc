// Makes paths comparable. The files do not have to exist.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace ex9000::sim {

/// Absolute, with symbolic links, `.` and `..` in its folder resolved; a link at `path` itself stays. If the
/// folder cannot be resolved, for example because links form a loop: only absolute.
inline std::string one_spelling(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  const std::filesystem::path folder = std::filesystem::weakly_canonical(absolute.parent_path(), error);
  return (error ? absolute : folder / absolute.filename()).string();
}

}  // namespace ex9000::sim
