// Makes paths comparable. The files do not have to exist.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace ex9000::sim {

/// Returns `path` as an absolute path, and resolves symbolic links, `.` and `..` in the path of its folder:
/// different spellings of the path of a file become equal. Does not follow a symbolic link at `path` itself.
/// If the path of the folder cannot be resolved, for example because symbolic links form a loop, returns
/// `path` as an absolute path and resolves nothing.
inline std::string one_spelling(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  const std::filesystem::path folder = std::filesystem::weakly_canonical(absolute.parent_path(), error);
  return (error ? absolute : folder / absolute.filename()).string();
}

}  // namespace ex9000::sim
