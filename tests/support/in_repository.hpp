// Paths of programs and files of the repository. CMake gives the tests only paths relative to the root, so
// that a clone in another folder can take their objects from ccache.
#pragma once

#include <filesystem>
#include <string>

namespace ex9000 {

/// Returns the absolute path of a file or a folder. `path`: relative to the root, which must be the working
/// directory.
inline std::string in_repository(const std::string& path) { return std::filesystem::absolute(path).string(); }

}  // namespace ex9000
