// Removes a new file unless the program decides to keep it.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <utility>

namespace ex9000::sim {

inline bool is_there(const std::string& path) {
  struct stat status {};
  return lstat(path.c_str(), &status) == 0;
}

/// The destructor removes the file, unless it `was_there` or `keep` was called.
class NewFile {
 public:
  NewFile(std::string path, bool was_there) : path_(std::move(path)), kept_(was_there) {}
  ~NewFile() {
    if (!kept_) {
      unlink(path_.c_str());
    }
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void keep() { kept_ = true; }

 private:
  std::string path_;
  bool kept_;
};

}  // namespace ex9000::sim
