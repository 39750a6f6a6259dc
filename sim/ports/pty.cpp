#include "sim/ports/pty.hpp"

#include <fcntl.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <utility>

#include "sim/ports/termios_rates.hpp"

namespace ex9000::sim {

namespace {

std::string reason() { return std::strerror(errno); }

std::optional<std::string> link_target(const std::string& link) {
  std::array<char, PATH_MAX> target{};
  const ssize_t size = readlink(link.c_str(), target.data(), target.size() - 1);
  return size < 0 ? std::nullopt
                  : std::optional<std::string>(std::string(target.data(), static_cast<std::size_t>(size)));
}

/// A running simulator keeps a record lock on its slave, which nobody else takes on a terminal, at a place
/// that follows from the path of its link: a link that a dead one has left may lead to where another is by
/// now.
struct flock lock_for(const std::string& link) {
  const std::filesystem::path path(link);
  const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code error;
  const std::filesystem::path canonical = std::filesystem::canonical(directory, error) / path.filename();
  constexpr std::size_t kMostOffset = 0x7FFF'FFFF;
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(std::hash<std::string>()(canonical.string()) & kMostOffset);
  lock.l_len = 1;
  return lock;
}

/// Whether a running simulator has this device under this link.
bool is_held(const std::string& device, const std::string& link) {
  const int fd = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    return false;
  }
  struct flock lock = lock_for(link);
  const bool held = fcntl(fd, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  close(fd);
  return held;
}

/// Makes room for the link, or throws.
void clear_the_way(const std::string& link) {
  struct stat status {};
  if (lstat(link.c_str(), &status) != 0) {
    return;
  }
  const auto target = link_target(link);
  if (!target || target->rfind("/dev/pts/", 0) != 0) {
    throw std::invalid_argument("--pty " + link +
                                ": something else is there; remove it or name another path");
  }
  if (is_held(*target, link)) {
    throw std::invalid_argument("--pty " + link +
                                ": another simulator is running there; end it or name another path");
  }
  unlink(link.c_str());
}

}  // namespace

Pty::Pty(std::string link, std::uint32_t baud) : link_(std::move(link)) {
  clear_the_way(link_);
  try {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
    std::array<char, 64> name{};
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name.data(), name.size()) != 0) {
      throw std::runtime_error("no pseudo-terminal to be had: " + reason());
    }
    device_ = name.data();
    slave_ = open(device_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    if (slave_ < 0 || tcgetattr(slave_, &settings) != 0) {
      throw std::runtime_error(device_ + ": " + reason());
    }
    cfmakeraw(&settings);
    if (const auto speed = termios_speed(baud)) {
      cfsetspeed(&settings, *speed);
    }
    struct flock lock = lock_for(link_);
    if (tcsetattr(slave_, TCSANOW, &settings) != 0 || fcntl(slave_, F_SETLK, &lock) != 0) {
      throw std::runtime_error(device_ + ": " + reason());
    }
    visits_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (visits_ < 0 || inotify_add_watch(visits_, device_.c_str(), IN_OPEN | IN_CLOSE) < 0) {
      throw std::runtime_error(device_ + ": " + reason());
    }
    if (symlink(device_.c_str(), link_.c_str()) != 0) {
      throw std::invalid_argument("--pty " + link_ + ": " + reason() + "; name a path that can be written");
    }
  } catch (...) {
    close_all();
    throw;
  }
}

Pty::~Pty() {
  if (link_target(link_) == device_) {
    unlink(link_.c_str());
  }
  close_all();
}

void Pty::take_visits() {
  alignas(inotify_event) std::array<char, 4096> buffer{};
  ssize_t size = 0;
  while ((size = ::read(visits_, buffer.data(), buffer.size())) > 0) {
    // Events of a watched file carry no name, so all are of one size.
    for (std::size_t at = 0; at < static_cast<std::size_t>(size); at += sizeof(inotify_event)) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + at, sizeof event);
      if ((event.mask & IN_OPEN) != 0) {
        ++visitors_;
      } else if (--visitors_ == 0) {
        tcflush(slave_, TCIFLUSH);
      }
    }
  }
}

void Pty::close_all() const {
  if (visits_ >= 0) {
    close(visits_);
  }
  if (slave_ >= 0) {
    close(slave_);
  }
  if (master_ >= 0) {
    close(master_);
  }
}

std::optional<std::uint32_t> Pty::baud() const {
  termios settings{};
  return tcgetattr(master_, &settings) == 0 ? termios_rate(settings) : std::nullopt;
}

}  // namespace ex9000::sim
