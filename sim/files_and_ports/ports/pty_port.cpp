#include "sim/files_and_ports/ports/pty_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sim/files_and_ports/files/new_file.hpp"
#include "sim/files_and_ports/ports/terminal_rate.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

/// Empty if `link` is not a symbolic link.
std::string link_target(const std::string& link) {
  std::error_code error;
  return std::filesystem::read_symlink(link, error).string();
}

/// Removes a link to a pseudo-terminal. Throws if another simulator uses the path, or anything else is there.
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

/// For a moment, to set it up or discard its unread bytes. Visits reports this like a master's visit.
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

PtyPort::PtyPort(boost::asio::io_context& io, std::string link, std::uint32_t baud,
                 const std::optional<PtyAccess>& access)
    : link_(std::move(link)), claim_(link_), visits_(boost::asio::use_service<Visits>(io)), descriptor_(io) {
  remove_stale(link_, claim_);
  master_ = FileDescriptor(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  std::array<char, 64> name{};
  if (!master_.is_open() || grantpt(master_.get()) != 0 || unlockpt(master_.get()) != 0 ||
      ptsname_r(master_.get(), name.data(), name.size()) != 0) {
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
  watch_ = with_place(link_ + ": ", [&] { return visits_.watch(device_, [this] { visited(); }); });
  if (symlink(device_.c_str(), link_.c_str()) != 0) {
    const std::string why = reason();
    visits_.ignore(watch_);
    throw std::invalid_argument(link_ + ": " + why + "; name a path that can be written");
  }
}

PtyPort::~PtyPort() {
  descriptor_.release();  // it does not own the file descriptor
  visits_.ignore(watch_);
  if (link_target(link_) == device_) {
    unlink(link_.c_str());
  }
}

PortSummary PtyPort::summary() const {
  return {"pty", link_, "pseudo-terminal " + shell_word(link_) + " (" + device_ + ")"};
}

std::optional<std::uint32_t> PtyPort::baud() const { return terminal_rate(master_.get()); }

void PtyPort::start(Arrivals& arrivals) {
  arrivals_ = &arrivals;
  descriptor_.assign(master_.get());
  read();
}

/// A master has opened or closed the slave.
void PtyPort::visited() {
  if (!is_open_at_a_master()) {
    end_visit();
  } else if (arrivals_ != nullptr) {
    let_line_go(*arrivals_);
  }
  read();
}

bool PtyPort::is_open_at_a_master() const {
  pollfd master{master_.get(), 0, 0};
  return poll(&master, 1, 0) == 0 || (master.revents & POLLHUP) == 0;
}

/// Discards what no master has read, like a serial port: the next master must not get a reply to the previous
/// one. Not if that master has already opened the slave. Clears CLOCAL, so that the next master can set it.
void PtyPort::end_visit() {
  if (unread_) {
    unread_ = false;
    tcflush(open_slave(device_).get(), TCIFLUSH);
  }
  // tcsetattr() fails with EINVAL if nothing of a request takes effect. A pseudo-terminal drops parity, so a
  // program that asks for the previous settings and parity would fail. With CLOCAL cleared, which nearly all
  // programs set and which means nothing here, something takes effect. Unlike tcsetattr(), this changes
  // nothing else, even if a master opens the slave now.
  const int off = 0;
  ioctl(master_.get(), TIOCSSOFTCAR, &off);
}

std::size_t PtyPort::send(const std::vector<std::uint8_t>& bytes) {
  if (!is_open_at_a_master()) {
    return 0;
  }
  unread_ = true;
  const ssize_t written = write(master_.get(), bytes.data(), bytes.size());
  return bytes.size() - (written < 0 ? 0 : static_cast<std::size_t>(written));
}

void PtyPort::resume() {
  paused_ = false;
  read();
}

void PtyPort::read() {
  if (arrivals_ == nullptr || reading_ || paused_) {
    return;
  }
  reading_ = true;
  descriptor_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                         [this](const boost::system::error_code& error) {
                           reading_ = false;
                           if (!error && !paused_ && take() >= 0) {
                             read();
                           }
                         });
}

void PtyPort::read_waiting() {
  while (!paused_ && take() > 0) {
  }
}

/// The number of bytes. 0: none, but a master has the pseudo-terminal open; negative: none has.
ssize_t PtyPort::take() {
  visits_.take();  // a new master must be detected before the program replies to its bytes
  const ssize_t size = ::read(master_.get(), bytes_.data(), bytes_.size());
  if (size > 0) {
    paused_ = !arrivals_->bytes(*this, {bytes_.data(), static_cast<std::size_t>(size)}, {}, nullptr);
    return size;
  }
  return size < 0 && errno == EAGAIN ? 0 : -1;
}

}  // namespace ex9000::sim
