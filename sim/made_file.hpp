// A file that goes again unless all goes well.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <utility>

namespace ex9000::sim {

/// What was not there before this object is removed with it, unless it is kept.
class MadeFile {
 public:
  explicit MadeFile(std::string path) : path_(std::move(path)) {
    struct stat status {};
    kept_ = lstat(path_.c_str(), &status) == 0;
  }
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
