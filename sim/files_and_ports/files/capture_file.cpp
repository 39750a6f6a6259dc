#include "sim/files_and_ports/files/capture_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <stdexcept>
#include <utility>

#include "sim/text/system_error.hpp"

namespace ex9000::sim {

CaptureFile::CaptureFile(std::string path, const std::string& place, GivesUp gives_up)
    : path_(std::move(path)), where_(place + path_), gives_up_(std::move(gives_up)) {
  // Without O_NONBLOCK, open would wait until a pipe has a reader.
  constexpr int kFlags = O_WRONLY | O_CLOEXEC | O_NONBLOCK;
  constexpr mode_t kAsUmaskPermits = 0666;
  fd_ = open(path_.c_str(), kFlags | O_CREAT | O_EXCL, kAsUmaskPermits);
  made_ = fd_ >= 0;
  if (fd_ < 0 && errno == EEXIST) {
    fd_ = open(path_.c_str(), kFlags);
  }
  if (fd_ < 0 && errno == ENXIO) {
    refuse("the pipe has no reader; start its reader first");
  }
  struct stat status {};
  if (fd_ < 0 || fstat(fd_, &status) != 0 || fcntl(fd_, F_SETFL, 0) != 0) {
    refuse(reason() + "; name a path that can be written");
  }
  regular_ = S_ISREG(status.st_mode);
  if (regular_ && flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    refuse("the file is in use by another simulator; end that simulator or name another path");
  }
}

CaptureFile::~CaptureFile() {
  if (made_ && !begun_) {
    unlink(path_.c_str());
  }
  close(fd_);
}

void CaptureFile::begin() {
  if (regular_ && ftruncate(fd_, 0) != 0) {
    throw std::runtime_error(where_ + ": cannot be overwritten: " + reason());
  }
  begun_ = true;
}

void CaptureFile::append(const std::vector<std::uint8_t>& block) {
  const off_t before = regular_ ? lseek(fd_, 0, SEEK_CUR) : 0;
  for (std::size_t done = 0; done < block.size() && !given_up_;) {
    if (!wait_for_room(fd_, gives_up_)) {
      given_up_ = true;
      return;
    }
    // A pipe that has room accepts PIPE_BUF bytes without blocking.
    const std::size_t piece =
        regular_ ? block.size() - done : std::min<std::size_t>(block.size() - done, PIPE_BUF);
    const ssize_t written = write(fd_, block.data() + done, piece);
    if (written < 0 && errno != EINTR) {
      const std::string why = reason();
      if (regular_ && ftruncate(fd_, before) != 0) {
        throw std::runtime_error(where_ + ": cannot be written, and its last frame is incomplete: " + why);
      }
      throw std::runtime_error(where_ + ": cannot be written: " + why);
    }
    done += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
}

void CaptureFile::refuse(const std::string& why) {
  if (fd_ >= 0) {
    close(std::exchange(fd_, -1));
  }
  throw std::invalid_argument(where_ + ": " + why);
}

}  // namespace ex9000::sim
