#include "sim/files/eeprom_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "hal/doubles/memory.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

namespace {

constexpr std::size_t kSize = hal::doubles::Memory::kSize;

/// Returns the umask. The caller sets the usual permissions with it, because those of mkostemp are more
/// restrictive.
mode_t file_mask() {
  const mode_t mask = umask(0);
  umask(mask);
  return mask;
}

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

/// Creates the file under a temporary name and links it when it is complete: if the process dies in between,
/// no incomplete file remains at `path`.
void EepromFile::create(const std::vector<std::uint8_t>& image) {
  std::string draft = path_ + ".XXXXXX";
  fd_ = mkostemp(draft.data(), O_CLOEXEC);
  if (fd_ < 0) {
    refuse("cannot be created: " + reason() + "; name a path that can be written");
  }
  const bool made = fchmod(fd_, 0666 & ~file_mask()) == 0 && write(0, {image.data(), image.size()}) &&
                    flock(fd_, LOCK_EX | LOCK_NB) == 0 && link(draft.c_str(), path_.c_str()) == 0;
  const std::string why =
      errno == EEXIST ? "the file was created meanwhile, or the path is a dangling link" : reason();
  unlink(draft.c_str());
  if (!made) {
    refuse("cannot be created: " + why + "; name a path that can be written");
  }
}

bool EepromFile::write(std::uint16_t address, Bytes bytes) const {
  const ssize_t written = pwrite(fd_, bytes.data, bytes.size, address);
  if (written >= 0 && static_cast<std::size_t>(written) < bytes.size) {
    errno = ENOSPC;
  }
  return written == static_cast<ssize_t>(bytes.size);
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
