#include "tests/qemu/unix_socket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <utility>

namespace ex9000::rig {

namespace {

bool readable(int fd, std::chrono::nanoseconds patience) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t left = patience.count() > 0 ? patience.count() : 0;
  const timespec time{left / kSecond, left % kSecond};
  pollfd ready{fd, POLLIN, 0};
  return ppoll(&ready, 1, &time, nullptr) == 1;
}

}  // namespace

UnixSocket::~UnixSocket() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

UnixSocket::UnixSocket(UnixSocket&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), received_(std::move(other.received_)) {}

void UnixSocket::send(const std::uint8_t* bytes, std::size_t size) {
  while (size != 0) {
    const ssize_t taken = ::send(fd_, bytes, size, MSG_NOSIGNAL);
    if (taken <= 0) {
      throw std::runtime_error("emulator: it has closed the connection; expected it to take all bytes");
    }
    bytes += taken;
    size -= static_cast<std::size_t>(taken);
  }
}

void UnixSocket::send(const std::string& text) {
  send(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

std::vector<std::uint8_t> UnixSocket::receive(std::chrono::nanoseconds patience) {
  std::array<std::uint8_t, 4096> buffer{};
  if (!readable(fd_, patience)) {
    return {};
  }
  const ssize_t size = recv(fd_, buffer.data(), buffer.size(), 0);
  if (size <= 0) {
    throw std::runtime_error("emulator: it has closed the connection; expected bytes");
  }
  return {buffer.begin(), buffer.begin() + size};
}

void UnixSocket::receive_all(std::uint8_t* bytes, std::size_t size) {
  while (size != 0) {
    const ssize_t received = readable(fd_, kHang) ? recv(fd_, bytes, size, 0) : 0;
    if (received <= 0) {
      throw std::runtime_error(
          "emulator: it has closed the connection or sent nothing for 60 s; expected more bytes");
    }
    bytes += received;
    size -= static_cast<std::size_t>(received);
  }
}

bool UnixSocket::has_bytes() const { return readable(fd_, std::chrono::nanoseconds(0)); }

bool wait_for_any(const std::vector<const UnixSocket*>& sockets) {
  std::vector<pollfd> ready;
  for (const UnixSocket* socket : sockets) {
    ready.push_back({socket->fd(), POLLIN, 0});
  }
  const auto limit = std::chrono::duration_cast<std::chrono::milliseconds>(kHang);
  return poll(ready.data(), ready.size(), static_cast<int>(limit.count())) > 0;
}

std::string UnixSocket::receive_line() {
  for (std::size_t end = received_.find('\n'); end == std::string::npos; end = received_.find('\n')) {
    const std::vector<std::uint8_t> bytes = receive(kHang);
    if (bytes.empty()) {
      throw std::runtime_error("emulator: it has sent nothing for 60 s; expected a line");
    }
    received_.append(bytes.begin(), bytes.end());
  }
  const std::size_t end = received_.find('\n');
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  return line;
}

UnixListener::UnixListener(const std::string& path) : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    throw std::runtime_error(path + ": the path is too long for a socket; expected fewer than " +
                             std::to_string(sizeof address.sun_path) + " characters");
  }
  path.copy(static_cast<char*>(address.sun_path), path.size());
  if (bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(fd_, 1) != 0) {
    const std::string why = std::strerror(errno);
    close(fd_);
    throw std::runtime_error(path + ": cannot listen: " + why + "; expected a path that can be created");
  }
}

UnixListener::~UnixListener() { close(fd_); }

std::optional<UnixSocket> UnixListener::accept(int ended) {
  std::array<pollfd, 2> ready{{{fd_, POLLIN, 0}, {ended, POLLIN, 0}}};
  const auto limit = std::chrono::duration_cast<std::chrono::milliseconds>(kHang);
  if (poll(ready.data(), ready.size(), static_cast<int>(limit.count())) <= 0) {
    throw std::runtime_error(
        "emulator: it has not connected for 60 s; expected it to connect when it starts");
  }
  if (ready[0].revents == 0) {
    return std::nullopt;
  }
  return UnixSocket(accept4(fd_, nullptr, nullptr, SOCK_CLOEXEC));
}

}  // namespace ex9000::rig
