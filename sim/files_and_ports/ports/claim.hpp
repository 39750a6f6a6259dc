// A lock for a path.
#pragma once

#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// At most one object in all processes holds a path's claim; any end of its process releases it, so a
/// simulator's file at an unclaimed path is no longer in use. Works between users, in one network namespace.
class Claim {
 public:
  explicit Claim(const std::string& path);

  /// false: another object or process holds it, or the system could not create a socket.
  [[nodiscard]] bool held() const { return socket_.is_open(); }

 private:
  FileDescriptor socket_;
};

}  // namespace ex9000::sim
