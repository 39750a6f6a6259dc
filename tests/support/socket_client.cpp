#include "tests/support/socket_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

#include "tests/support/hang.hpp"

namespace ex9000::system {

SocketClient::SocketClient(std::uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int on = 1;
  setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(fd_);
    throw std::runtime_error("no program listens at port " + std::to_string(port));
  }
}

SocketClient::~SocketClient() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

void SocketClient::abort() {
  const linger at_once{1, 0};
  setsockopt(fd_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(fd_);
  fd_ = -1;
}

void SocketClient::send(const std::vector<std::uint8_t>& bytes) {
  if (::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("cannot send");
  }
}

void SocketClient::close_writing() { shutdown(fd_, SHUT_WR); }

std::vector<std::uint8_t> SocketClient::receive(std::size_t count) {
  std::vector<std::uint8_t> bytes;
  while (bytes.size() < count) {
    const std::vector<std::uint8_t> more = receive_some(kHang);
    if (more.empty()) {
      break;
    }
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

std::vector<std::uint8_t> SocketClient::receive_some(std::chrono::milliseconds patience) {
  pollfd ready{fd_, POLLIN, 0};
  std::array<std::uint8_t, 4096> buffer{};
  if (poll(&ready, 1, static_cast<int>(patience.count())) != 1) {
    return {};
  }
  const ssize_t size = recv(fd_, buffer.data(), buffer.size(), 0);
  return {buffer.begin(), buffer.begin() + (size < 0 ? 0 : size)};
}

std::string SocketClient::receive_text(std::size_t count) {
  const std::vector<std::uint8_t> bytes = receive(count);
  return {bytes.begin(), bytes.end()};
}

bool SocketClient::hears_nothing_for(std::chrono::milliseconds time) {
  pollfd ready{fd_, POLLIN, 0};
  return poll(&ready, 1, static_cast<int>(time.count())) == 0;
}

bool SocketClient::closed() {
  pollfd ready{fd_, POLLIN, 0};
  char byte = 0;
  return poll(&ready, 1, kHangMilliseconds) == 1 && recv(fd_, &byte, 1, 0) <= 0;
}

}  // namespace ex9000::system
