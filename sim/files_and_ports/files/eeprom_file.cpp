#include "sim/files_and_ports/files/eeprom_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <utility>

#include "hal/doubles/memory.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

namespace {

constexpr std::size_t kSize = hal::doubles::Memory::kSize;

/// Gets its final name only when it is complete.
class Draft {
 public:
  /// Has no name, so that nothing remains if the process is killed. If the file system does not support that,
  /// or /proc is missing, which `link_to` would need, it has a temporary name.
  explicit Draft(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    constexpr mode_t kAsUmaskPermits = 0666;
    constexpr int kFlags = O_RDWR | O_CLOEXEC;
    file_ = FileDescriptor(open(folder.empty() ? "." : folder.c_str(), kFlags | O_TMPFILE, kAsUmaskPermits));
    name_ = "/proc/self/fd/" + std::to_string(file_.get());
    const bool supported =
        file_.is_open() ? access(name_.c_str(), F_OK) == 0 : errno != EOPNOTSUPP && errno != EISDIR;
    if (!supported) {
      name_ = path + "." + std::to_string(getpid());
      file_ = FileDescriptor(open(name_.c_str(), kFlags | O_CREAT | O_EXCL, kAsUmaskPermits));
      temporary_ = file_.is_open();
    }
  }
  ~Draft() {
    if (temporary_) {
      unlink(name_.c_str());
    }
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// Not open if opening has failed.
  [[nodiscard]] FileDescriptor take_file() { return std::move(file_); }
  /// false: the system call has failed, for example because `path` exists.
  [[nodiscard]] bool link_to(const std::string& path) const {
    return linkat(AT_FDCWD, name_.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
  }

 private:
  FileDescriptor file_;
  std::string name_;
  bool temporary_ = false;
};

/// Returns the file's mode. Call it directly after open(): if that has failed, the message has the reason
/// from errno, and `access`, which is "read" or "read and written".
mode_t require_image(const FileDescriptor& file, const std::string& path, const char* access) {
  struct stat status {};
  if (!file.is_open() || fstat(file.get(), &status) != 0) {
    fail(path + ": " + reason() + "; name a file that can be " + access);
  }
  if (!S_ISREG(status.st_mode)) {
    fail(path + ": is not a regular file; name another path");
  }
  if (status.st_size != static_cast<off_t>(kSize)) {
    fail(path + ": has " + std::to_string(status.st_size) + " bytes, but an image of the EEPROM has " +
         std::to_string(kSize) + " bytes; remove this file or name another path");
  }
  return status.st_mode;
}

std::vector<std::uint8_t> image_in(const FileDescriptor& file, const std::string& path) {
  std::vector<std::uint8_t> image(kSize);
  if (pread(file.get(), image.data(), kSize, 0) != static_cast<ssize_t>(kSize)) {
    fail(path + ": cannot be read: " + reason() + "; name another path");
  }
  return image;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> read_eeprom_file(const std::string& path) {
  const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open() && errno == ENOENT) {
    return std::nullopt;
  }
  require_image(file, path, "read");
  return image_in(file, path);
}

EepromFile::EepromFile(std::string path)
    : path_(std::move(path)), file_(open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
  if (!file_.is_open() && errno == ENOENT) {
    return;
  }
  const mode_t mode = require_image(file_, path_, "read and written");
  // Without any write permission, a file is protected; open() alone would let root write to it.
  if ((mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0) {
    fail(path_ + ": is read-only; make it writable with chmod u+w, or name another path");
  }
  if (flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    unavailable(path_ + ": " +
                (errno == EWOULDBLOCK ? "is in use by another program; end that program or name another path"
                                      : reason() + "; name another path"));
  }
  found_ = image_in(file_, path_);
}

void EepromFile::create(const std::vector<std::uint8_t>& image) {
  Draft draft(path_);
  file_ = draft.take_file();
  if (!file_.is_open() || !write(0, {image.data(), image.size()}) ||
      flock(file_.get(), LOCK_EX | LOCK_NB) != 0 || !draft.link_to(path_)) {
    const std::string why =
        errno == EEXIST ? "another program has created the file, or the path is a link to a missing file"
                        : reason();
    fail(path_ + ": cannot be created: " + why + "; name a path that can be written");
  }
}

bool EepromFile::write(std::uint16_t address, Bytes bytes) const {
  // After an incomplete write, the next one fails and sets errno to the reason.
  ssize_t written = 0;
  for (std::size_t done = 0; done < bytes.size && written >= 0; done += static_cast<std::size_t>(written)) {
    written = pwrite(file_.get(), bytes.data + done, bytes.size - done, static_cast<off_t>(address + done));
  }
  return written >= 0;
}

}  // namespace ex9000::sim
