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

#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

CaptureFile::CaptureFile(const std::string& path, const std::string& place, GivesUp gives_up)
    : where_(place + path), gives_up_(std::move(gives_up)) {
  // Without O_NONBLOCK, open would wait for a reader of a pipe.
  constexpr int kFlags = O_WRONLY | O_APPEND | O_CLOEXEC | O_NONBLOCK;
  constexpr mode_t kAsUmaskPermits = 0666;
  file_ = FileDescriptor(open(path.c_str(), kFlags | O_CREAT | O_EXCL, kAsUmaskPermits));
  if (!file_.is_open() && errno == EEXIST) {
    file_ = FileDescriptor(open(path.c_str(), kFlags));
  }
  if (!file_.is_open() && errno == ENXIO) {
    unavailable(where_ + ": the pipe has no reader; start its reader first");
  }
  struct stat status {};
  if (!file_.is_open() || fstat(file_.get(), &status) != 0 || fcntl(file_.get(), F_SETFL, O_APPEND) != 0) {
    fail(where_ + ": " + reason() + "; name a path that can be written");
  }
  regular_ = S_ISREG(status.st_mode);
  if (regular_ && flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    unavailable(where_ +
                ": the file is in use by another simulator; end that simulator or name another path");
  }
}

void CaptureFile::begin() {
  if (regular_ && ftruncate(file_.get(), 0) != 0) {
    throw std::runtime_error(where_ + ": cannot be overwritten: " + reason());
  }
}

void CaptureFile::append(const std::vector<std::uint8_t>& block) {
  const off_t before = regular_ ? lseek(file_.get(), 0, SEEK_END) : 0;
  for (std::size_t done = 0; done < block.size() && !given_up_;) {
    if (!wait_for_room(file_.get(), gives_up_)) {
      given_up_ = true;
      return;
    }
    // A pipe that has room accepts PIPE_BUF bytes without blocking.
    const std::size_t piece =
        regular_ ? block.size() - done : std::min<std::size_t>(block.size() - done, PIPE_BUF);
    const ssize_t written = write(file_.get(), block.data() + done, piece);
    if (written < 0 && errno != EINTR) {
      const std::string why = reason();
      if (regular_ && ftruncate(file_.get(), before) != 0) {
        throw std::runtime_error(where_ + ": cannot be written, and its last block is incomplete: " + why);
      }
      throw std::runtime_error(where_ + ": cannot be written: " + why);
    }
    done += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
}

}  // namespace ex9000::sim
