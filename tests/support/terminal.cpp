#include "tests/support/terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "tests/support/any_rate.hpp"

namespace ex9000::system {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

}  // namespace

Terminal::Terminal(const std::string& tty, std::uint32_t baud)
    : fd_(open(tty.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
  if (fd_ < 0) {
    fail(tty);
  }
  set_baud(baud);
}

Terminal::~Terminal() { close(fd_); }

void Terminal::set_baud(std::uint32_t baud) {
  termios settings{};
  tcgetattr(fd_, &settings);
  cfmakeraw(&settings);
  cfsetspeed(&settings, baud);
  if (tcsetattr(fd_, TCSANOW, &settings) != 0) {
    fail("tcsetattr");
  }
}

bool Terminal::set_even_parity(std::uint32_t baud) {
  termios settings{};
  tcgetattr(fd_, &settings);
  cfmakeraw(&settings);
  cfsetspeed(&settings, baud);
  settings.c_cflag |= CLOCAL | CREAD | PARENB;
  return tcsetattr(fd_, TCSANOW, &settings) == 0;
}

void Terminal::set_any_rate(std::uint32_t baud) {
  if (!system::set_any_rate(fd_, baud)) {
    fail("TCSETS2");
  }
}

void Terminal::write(const std::vector<std::uint8_t>& bytes) {
  if (::write(fd_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
    fail("write");
  }
}

void Terminal::type(const std::string& text) { write({text.begin(), text.end()}); }

std::vector<std::uint8_t> Terminal::read(std::chrono::nanoseconds patience) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(patience);
  const timespec timeout{seconds.count(), (patience - seconds).count()};
  pollfd ready{fd_, POLLIN, 0};
  if (ppoll(&ready, 1, &timeout, nullptr) != 1) {
    return {};
  }
  std::array<std::uint8_t, 4096> buffer{};
  const ssize_t size = ::read(fd_, buffer.data(), buffer.size());
  if (size < 0) {
    fail("read");
  }
  received_ += static_cast<std::uint64_t>(size);
  return {buffer.begin(), buffer.begin() + size};
}

std::string Terminal::read_line(std::chrono::milliseconds patience) {
  std::string line;
  while (line.empty() || line.back() != '\r') {
    const std::vector<std::uint8_t> bytes = read(patience);
    if (bytes.empty()) {
      break;
    }
    line.append(bytes.begin(), bytes.end());
  }
  return line;
}

}  // namespace ex9000::system
