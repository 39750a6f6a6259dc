#include "tests/bench/load/polling_master.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/support/hang.hpp"

namespace ex9000::bench {

namespace {

constexpr std::uint8_t kReadCoils = 0x01;
constexpr std::uint8_t kCoils = 13;
constexpr std::size_t kReply = 7;  // unit, function, size, two bytes of coils, CRC

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

}  // namespace

PollingMaster PollingMaster::over_tcp(std::uint16_t port) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int on = 1;
  if (fd < 0 || setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on) != 0 ||
      connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    fail("port " + std::to_string(port));
  }
  return PollingMaster(fd);
}

PollingMaster PollingMaster::over_tty(const std::string& path) {
  const int fd = open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (fd < 0 || tcgetattr(fd, &settings) != 0) {
    fail(path);
  }
  cfmakeraw(&settings);
  if (tcsetattr(fd, TCSANOW, &settings) != 0) {
    fail(path);
  }
  return PollingMaster(fd);
}

PollingMaster PollingMaster::over_new_tty(std::string& path) {
  const int fd = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::array<char, 64> name{};
  if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0 || ptsname_r(fd, name.data(), name.size()) != 0) {
    fail("a pseudo-terminal");
  }
  path = name.data();
  return PollingMaster(fd);
}

PollingMaster::PollingMaster(PollingMaster&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

PollingMaster::~PollingMaster() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

void PollingMaster::ask(const std::vector<std::uint8_t>& request, std::uint8_t unit) {
  if (write(fd_, request.data(), request.size()) != static_cast<ssize_t>(request.size())) {
    fail("cannot send a request");
  }
  std::array<std::uint8_t, kReply> reply{};
  for (std::size_t size = 0; size < reply.size();) {
    pollfd waits{fd_, POLLIN, 0};
    if (poll(&waits, 1, kHangMilliseconds) != 1) {
      throw std::runtime_error("no reply within 60 s");
    }
    const ssize_t count = read(fd_, reply.data() + size, reply.size() - size);
    if (count <= 0) {
      fail("cannot receive a reply");
    }
    size += static_cast<std::size_t>(count);
  }
  if (reply[0] != unit || reply[1] != kReadCoils || reply[2] != 2) {
    throw std::runtime_error("wrong reply; expected the requested unit, function 01, and 2 bytes of coils");
  }
}

std::uint64_t PollingMaster::poll_until(std::chrono::steady_clock::time_point end, unsigned units) {
  std::vector<std::vector<std::uint8_t>> requests;
  for (unsigned unit = 1; unit <= units; ++unit) {
    requests.push_back(with_crc({static_cast<std::uint8_t>(unit), kReadCoils, 0, 0, 0, kCoils}));
  }
  std::uint64_t transactions = 0;
  while (std::chrono::steady_clock::now() < end) {
    const std::size_t which = transactions++ % requests.size();
    ask(requests[which], requests[which][0]);
  }
  return transactions;
}

}  // namespace ex9000::bench
