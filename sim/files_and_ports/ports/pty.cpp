#include "sim/files_and_ports/ports/pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sim/files_and_ports/files/new_file.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

namespace {

/// Returns the target of a symbolic link; empty if `link` is not one.
std::string link_target(const std::string& link) {
  std::error_code error;
  return std::filesystem::read_symlink(link, error).string();
}

/// If a link to a pseudo-terminal exists at the path `link`, removes it. Throws if another simulator uses the
/// path, or if any other file exists at the path.
void remove_stale(const std::string& link, const Claim& claim) {
  if (!claim.held()) {
    unavailable(link + ": another simulator uses this path; end that simulator or name another path");
  }
  if (!is_there(link)) {
    return;
  }
  if (link_target(link).rfind("/dev/pts/", 0) != 0) {
    throw std::invalid_argument(
        link + ": exists and is not a link to a pseudo-terminal; remove it or name another path");
  }
  unlink(link.c_str());
}

/// Opens the slave for a short time, to set it up or to discard its unread bytes. If Visits watches the
/// device, Visits reports this like a master that opens and closes the slave.
FileDescriptor open_slave(const std::string& device) {
  return FileDescriptor(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
}

bool set_up(const FileDescriptor& slave, std::uint32_t baud) {
  termios settings{};
  if (!slave.is_open() || tcgetattr(slave.get(), &settings) != 0) {
    return false;
  }
  cfmakeraw(&settings);
  cfsetspeed(&settings, baud);
  return tcsetattr(slave.get(), TCSANOW, &settings) == 0;
}

}  // namespace

Pty::Pty(std::string link, std::uint32_t baud, const std::optional<PtyAccess>& access)
    : link_(std::move(link)), claim_(link_) {
  remove_stale(link_, claim_);
  master_ = FileDescriptor(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  std::array<char, 64> name{};
  if (!master_.is_open() || grantpt(master_fd()) != 0 || unlockpt(master_fd()) != 0 ||
      ptsname_r(master_fd(), name.data(), name.size()) != 0) {
    throw std::runtime_error(link_ + ": cannot create a pseudo-terminal: " + reason());
  }
  device_ = name.data();
  if (!set_up(open_slave(device_), baud)) {
    throw std::runtime_error(link_ + ": cannot set up " + device_ + ": " + reason());
  }
  if (access && access->group && chown(device_.c_str(), geteuid(), *access->group) != 0) {
    fail(link_ + ": the group " + std::to_string(*access->group) + " is refused: " + reason() +
         "; name a group of the user that runs the simulator");
  }
  if (access && chmod(device_.c_str(), access->mode) != 0) {
    throw std::runtime_error(link_ + ": cannot set the mode of " + device_ + ": " + reason());
  }
  if (symlink(device_.c_str(), link_.c_str()) != 0) {
    throw std::invalid_argument(link_ + ": " + reason() + "; name a path that can be written");
  }
}

Pty::~Pty() {
  if (link_target(link_) == device_) {
    unlink(link_.c_str());
  }
}

bool Pty::visited() const {
  pollfd master{master_fd(), 0, 0};
  return poll(&master, 1, 0) == 0 || (master.revents & POLLHUP) == 0;
}

bool Pty::take_visit() {
  if (visited()) {
    return true;
  }
  if (unread_) {
    unread_ = false;
    tcflush(open_slave(device_).get(), TCIFLUSH);
  }
  // tcsetattr() fails with EINVAL if nothing of a request takes effect. A pseudo-terminal drops parity, so a
  // second program that asks for the settings of the first and for parity would fail. CLOCAL has no effect on
  // a pseudo-terminal, and nearly all programs set it. Unlike tcsetattr(), this call changes nothing else,
  // even if a master opens the slave at this moment.
  const int off = 0;
  ioctl(master_fd(), TIOCSSOFTCAR, &off);
  return false;
}

std::size_t Pty::write(const std::vector<std::uint8_t>& bytes) {
  if (!visited()) {
    return 0;
  }
  unread_ = true;
  const ssize_t written = ::write(master_fd(), bytes.data(), bytes.size());
  return bytes.size() - (written < 0 ? 0 : static_cast<std::size_t>(written));
}

}  // namespace ex9000::sim
