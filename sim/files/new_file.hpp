// A file that is removed again unless the work succeeds.
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

/// The destructor removes the file if it did not exist before, unless `keep` was called.
class MadeFile {
 public:
  MadeFile(std::string path, bool was_there) : path_(std::move(path)), kept_(was_there) {}
  ~MadeFile() {
    if (!kept_) {
      unlink(path_.c_str());
    }
  }
  MadeFile(const MadeFile&) = delete;
  MadeFile& operator=(const MadeFile&) = delete;

  void keep() { kept_ = true; }

 private:
  std::string path_;
  bool kept_;
};

}  // namespace ex9000::sim
