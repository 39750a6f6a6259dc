#include "sim/files_and_ports/ports/claim.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <functional>

#include "sim/files_and_ports/files/one_spelling.hpp"

namespace ex9000::sim {

/// The kernel gives the name of an abstract socket to one socket at a time, until it is closed. A hash,
/// because the path may be too long for a name.
Claim::Claim(const std::string& path) : socket_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "ex9000-sim/" + std::to_string(std::hash<std::string>()(one_spelling(path)));
  name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (held() && bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) {
    socket_ = FileDescriptor();
  }
}

}  // namespace ex9000::sim
