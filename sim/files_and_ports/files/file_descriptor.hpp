// A file descriptor with an owner.
#pragma once

#include <unistd.h>

#include <utility>

namespace ex9000::sim {

class FileDescriptor {
 public:
  FileDescriptor() = default;
  /// `fd`: the result of a system call; negative: nothing is open.
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(other.release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor() {
    if (is_open()) {
      close(fd_);
    }
  }

  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  [[nodiscard]] int get() const { return fd_; }
  /// The caller must close it.
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_ = -1;
};

}  // namespace ex9000::sim
