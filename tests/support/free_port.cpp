#include "tests/support/free_port.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>

namespace ex9000::system {
namespace {

constexpr unsigned kFirst = 10'000;
constexpr unsigned kCount = 22'000;
constexpr unsigned kPerProcess = 50;  // more ports than any test uses

bool is_free(unsigned port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool bound = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return bound;
}

}  // namespace

std::uint16_t free_port() {
  static unsigned next = static_cast<unsigned>(getpid()) * kPerProcess;
  for (unsigned tried = 0; tried < kCount; ++tried) {
    const unsigned port = kFirst + next++ % kCount;
    if (is_free(port)) {
      return static_cast<std::uint16_t>(port);
    }
  }
  throw std::runtime_error(
      "127.0.0.1: no TCP port from 10000 to 31999 is free; end programs that use these ports");
}

}  // namespace ex9000::system
