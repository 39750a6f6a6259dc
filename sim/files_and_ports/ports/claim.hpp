// A lock for a path. The path may remain after the process that created it has ended, but the lock does not.
#pragma once

#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// At most one process holds the claim for a path. The system releases the claim when this process ends, even
/// if a signal kills it. If a path exists and no process holds its claim, the process that created the path
/// has ended. A claim works between processes of all users, but only within one network namespace.
class Claim {
 public:
  explicit Claim(const std::string& path);

  /// Returns whether this object holds the claim. Returns false if another process or object holds it, or if
  /// the system could not create a socket.
  [[nodiscard]] bool held() const { return socket_.is_open(); }

 private:
  FileDescriptor socket_;
};

}  // namespace ex9000::sim
