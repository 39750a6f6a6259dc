// A lock for a path.
#pragma once

#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// At most one object in all processes holds the claim for a path. The destructor releases the claim. If the
/// process ends without the destructor, for example because a signal kills it, the system releases the claim.
/// Therefore, if no object holds the claim, a file that a simulator has created at the path is no longer in
/// use. A claim works between processes of all users, but only within one network namespace.
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
