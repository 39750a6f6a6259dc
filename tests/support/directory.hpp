// A temporary directory and the files in it.
#pragma once

#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <string>

namespace ex9000::system {

inline std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A temporary directory, which is empty at first. The destructor removes it with its content.
class Directory {
 public:
  Directory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "ex9000-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~Directory() { std::filesystem::remove_all(path_); }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns the path of the entry `name` in this directory.
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }

  /// Returns a description of each entry, also in subdirectories: the mode, the number of links, the target
  /// of a link, and the size and the hash of a file. The key is the path in this directory. A test can
  /// compare two results to detect changes.
  [[nodiscard]] std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> contents;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
      contents[entry.path().lexically_relative(path_).string()] = looks_of(entry);
    }
    return contents;
  }

 private:
  static std::string looks_of(const std::filesystem::directory_entry& entry) {
    struct stat status {};
    lstat(entry.path().c_str(), &status);
    std::string text =
        "mode " + std::to_string(status.st_mode) + ", links " + std::to_string(status.st_nlink);
    if (entry.is_symlink()) {
      text += ", to " + std::filesystem::read_symlink(entry.path()).string();
    } else if (entry.is_regular_file()) {
      const std::string bytes = bytes_of_file(entry.path().string());
      text += ", bytes " + std::to_string(bytes.size()) + ", hash " +
              std::to_string(std::hash<std::string>()(bytes));
    }
    return text;
  }

  std::string path_;
};

}  // namespace ex9000::system
