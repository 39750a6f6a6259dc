#include "sim/ports/serial_port.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "sim/ports/termios_rates.hpp"

namespace ex9000::sim {

namespace {

/// A reply goes out behind this much of itself, so that no hesitation of the host makes a gap in it.
constexpr std::chrono::milliseconds kCushion{10};

std::string reason() { return std::strerror(errno); }

/// Adapters like to wait up to 16 ms for more bytes, which tears frames apart. Not all can be told not to.
void ask_for_low_latency(int fd) {
  serial_struct settings{};
  if (ioctl(fd, TIOCGSERIAL, &settings) == 0) {
    settings.flags |= ASYNC_LOW_LATENCY;
    ioctl(fd, TIOCSSERIAL, &settings);
  }
}

}  // namespace

SerialPort::SerialPort(boost::asio::io_context& io, std::string device, std::uint32_t baud)
    : device_(std::move(device)), baud_(baud), descriptor_(io), echo_(baud) {
  try {
    open_device();
  } catch (...) {
    if (fd_ >= 0) {
      close(fd_);
    }
    throw;
  }
  descriptor_.assign(fd_);
}

SerialPort::~SerialPort() = default;

void SerialPort::open_device() {
  const auto refuse = [this](const std::string& why) {
    throw std::invalid_argument("--serial " + device_ + ": " + why);
  };
  fd_ = open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) {
    refuse(errno == EBUSY ? "another program has it; end that or name another port"
                          : reason() + "; name a serial port that can be read and written");
  }
  termios settings{};
  if (tcgetattr(fd_, &settings) != 0) {
    refuse("is no serial port; name one such as /dev/ttyUSB0");
  }
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0 || ioctl(fd_, TIOCEXCL) != 0) {
    refuse("another program has it; end that or name another port");
  }
  cfmakeraw(&settings);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cflag |= CLOCAL | CREAD;
  const auto speed = termios_speed(baud_);
  if (!speed || cfsetspeed(&settings, *speed) != 0 || tcsetattr(fd_, TCSANOW, &settings) != 0) {
    refuse("cannot be set to " + std::to_string(baud_) + " baud; --baud names another rate");
  }
  int modem_lines = 0;
  has_wires_ = ioctl(fd_, TIOCMGET, &modem_lines) == 0;
  ask_for_low_latency(fd_);
  tcflush(fd_, TCIOFLUSH);
}

void SerialPort::start(Received received) {
  received_ = std::move(received);
  read();
}

void SerialPort::resume() {
  if (paused_) {
    read();
  }
}

void SerialPort::read() {
  paused_ = false;
  descriptor_.async_read_some(
      boost::asio::buffer(buffer_), [this](const boost::system::error_code& error, std::size_t size) {
        if (error == boost::asio::error::operation_aborted) {
          return;
        }
        if (error) {
          throw std::runtime_error("--serial " + device_ + ": " + error.message() + "; the port has gone");
        }
        const bool echo = has_wires_ && echo_.covers(OwnEcho::Clock::now());
        paused_ = !echo && !received_(buffer_.data(), size);
        if (!paused_) {
          read();
        }
      });
}

void SerialPort::send(const std::vector<std::uint8_t>& bytes) {
  if (held_back_.empty()) {
    began_ = OwnEcho::Clock::now();
  }
  held_back_.insert(held_back_.end(), bytes.begin(), bytes.end());
  if (under_way_ || OwnEcho::Clock::now() - began_ >= kCushion) {
    write_out();
    under_way_ = true;
  }
}

void SerialPort::sent() {
  write_out();
  under_way_ = false;
}

void SerialPort::write_out() {
  [[maybe_unused]] const ssize_t written =
      write(descriptor_.native_handle(), held_back_.data(), held_back_.size());
  echo_.sent(held_back_.size(), OwnEcho::Clock::now());
  held_back_.clear();
}

}  // namespace ex9000::sim
