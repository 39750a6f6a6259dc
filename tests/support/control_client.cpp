#include "tests/support/control_client.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <stdexcept>

#include "tests/support/hang.hpp"

namespace ex9000::system {

ControlClient::ControlClient(const std::string& path) : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(fd_);
    throw std::runtime_error("no program listens at " + path);
  }
}

ControlClient::~ControlClient() { close(fd_); }

void ControlClient::send(const std::string& bytes) {
  if (::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the simulator has closed the connection");
  }
}

std::size_t ControlClient::offer(const std::string& bytes) {
  const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent < 0 ? 0 : static_cast<std::size_t>(sent);
}

void ControlClient::close_writing() { shutdown(fd_, SHUT_WR); }

/// Waits for bytes and stores them. Returns false if the connection has ended. Throws std::runtime_error
/// if neither bytes nor the end of the connection arrive within 60 s. This timeout only detects a program
/// that hangs.
bool ControlClient::read_more() {
  pollfd ready{fd_, POLLIN, 0};
  if (poll(&ready, 1, kHangMilliseconds) != 1) {
    throw std::runtime_error("the simulator has sent nothing for 60 s");
  }
  std::array<char, 4096> buffer{};
  const ssize_t size = recv(fd_, buffer.data(), buffer.size(), 0);
  if (size > 0) {
    input_.append(buffer.data(), static_cast<std::size_t>(size));
  }
  return size > 0;
}

std::string ControlClient::line() {
  auto end = input_.find('\n');
  while (end == std::string::npos) {
    if (!read_more()) {
      throw std::runtime_error("the simulator has closed the connection");
    }
    end = input_.find('\n');
  }
  const std::string line = input_.substr(0, end);
  input_.erase(0, end + 1);
  return line;
}

bool ControlClient::at_end() { return input_.empty() && !read_more(); }

std::string ControlClient::ask(const std::string& command) {
  send(command + "\n");
  return line();
}

std::string ControlClient::ok(const std::string& command) {
  const std::string reply = ask(command);
  if (reply.rfind("ok", 0) != 0) {
    throw std::runtime_error(command + ": " + reply);
  }
  return reply.size() > 3 ? reply.substr(3) : "";
}

}  // namespace ex9000::system
