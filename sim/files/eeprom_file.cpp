#include "sim/files/eeprom_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "hal/doubles/memory.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

namespace {

constexpr std::size_t kSize = hal::doubles::Memory::kSize;

/// A file that gets its name when it is complete: if the process dies before, no incomplete file remains.
class Draft {
 public:
  /// Opens the file in the folder of `path`. Some file systems do not support files without a name; there,
  /// the file has a temporary name.
  explicit Draft(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    constexpr mode_t kAsUmaskPermits = 0666;
    constexpr int kFlags = O_RDWR | O_CLOEXEC;
    fd_ = open(folder.empty() ? "." : folder.c_str(), kFlags | O_TMPFILE, kAsUmaskPermits);
    name_ = "/proc/self/fd/" + std::to_string(fd_);
    if (fd_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR)) {
      name_ = path + "." + std::to_string(getpid());
      fd_ = open(name_.c_str(), kFlags | O_CREAT | O_EXCL, kAsUmaskPermits);
      temporary_ = fd_ >= 0;
    }
  }
  ~Draft() {
    if (temporary_) {
      unlink(name_.c_str());
    }
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// The open file, which the caller has to close; -1 if it cannot be opened.
  [[nodiscard]] int fd() const { return fd_; }
  /// Does not replace an existing file. Returns false if the system call fails.
  [[nodiscard]] bool link_to(const std::string& path) const {
    return linkat(AT_FDCWD, name_.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
  }

 private:
  int fd_ = -1;
  std::string name_;
  bool temporary_ = false;
};

/// Returns the reason why an open file cannot be an image; empty if it may be an image.
std::string flaw_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return "is not a regular file; name another path";
  }
  if (status.st_size != static_cast<off_t>(kSize)) {
    return "has " + std::to_string(status.st_size) + " bytes, an image of the EEPROM has " +
           std::to_string(kSize) + "; remove it or name another path";
  }
  return "";
}

/// Throws std::runtime_error with a one-line message if reading fails.
std::vector<std::uint8_t> image_in(int fd) {
  std::vector<std::uint8_t> image(kSize);
  if (pread(fd, image.data(), kSize, 0) != static_cast<ssize_t>(kSize)) {
    throw std::runtime_error("cannot be read: " + reason() + "; name another path");
  }
  return image;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> read_eeprom_file(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0 && errno == ENOENT) {
    return std::nullopt;
  }
  std::string why;
  std::optional<std::vector<std::uint8_t>> image;
  struct stat status {};
  try {
    why = fd < 0 || fstat(fd, &status) != 0 ? reason() + "; name a file that can be read" : flaw_of(status);
    if (why.empty()) {
      image = image_in(fd);
    }
  } catch (const std::runtime_error& error) {
    why = error.what();
  }
  if (fd >= 0) {
    close(fd);
  }
  if (!why.empty()) {
    throw std::invalid_argument(path + ": " + why);
  }
  return image;
}

EepromFile::EepromFile(std::string path) : path_(std::move(path)) {
  fd_ = open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0 && errno == ENOENT) {
    return;
  }
  struct stat status {};
  if (fd_ < 0 || fstat(fd_, &status) != 0) {
    refuse(reason() + "; name a file that can be read and written");
  }
  if (const std::string why = flaw_of(status); !why.empty()) {
    refuse(why);
  }
  // A file without any write permission is protected; open() alone would let root write to it.
  if ((status.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0) {
    refuse("is read-only; chmod u+w, or name another path");
  }
  lock();
  try {
    found_ = image_in(fd_);
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
}

EepromFile::~EepromFile() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

void EepromFile::create(const std::vector<std::uint8_t>& image) {
  const Draft draft(path_);
  fd_ = draft.fd();
  if (fd_ < 0 || !write(0, {image.data(), image.size()}) || flock(fd_, LOCK_EX | LOCK_NB) != 0 ||
      !draft.link_to(path_)) {
    const std::string why =
        errno == EEXIST ? "the file was created meanwhile, or the path is a dangling link" : reason();
    refuse("cannot be created: " + why + "; name a path that can be written");
  }
}

bool EepromFile::write(std::uint16_t address, Bytes bytes) const {
  // After an incomplete write, the next one fails with the reason.
  ssize_t written = 0;
  for (std::size_t done = 0; done < bytes.size && written >= 0; done += static_cast<std::size_t>(written)) {
    written = pwrite(fd_, bytes.data + done, bytes.size - done, static_cast<off_t>(address + done));
  }
  return written >= 0;
}

void EepromFile::lock() {
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    refuse(errno == EWOULDBLOCK ? "is in use by another module; end that simulator or name another path"
                                : reason() + "; name another path");
  }
}

void EepromFile::refuse(const std::string& why) {
  if (fd_ >= 0) {
    close(std::exchange(fd_, -1));
  }
  throw std::invalid_argument(path_ + ": " + why);
}

}  // namespace ex9000::sim
