// A lock for a path. A file at the path may remain after the process that created the file has ended, but the
// lock does not remain.
#pragma once

#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// At most one object in all processes holds the claim for a path. The destructor releases the claim. The
/// system releases it too when the process ends, even if a signal kills the process. If a simulator has
/// created the file at a path and no object holds the claim for the path, this simulator no longer uses the
/// file. A claim works between processes of all users, but only within one network namespace.
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
