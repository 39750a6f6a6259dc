// A lock for a path. The path may remain after the process that created it has ended, but the lock does not.
#pragma once

#include <string>

#include "sim/files/file_descriptor.hpp"

namespace ex9000::sim {

/// Only one process holds a claim at a time, and the system releases it when the process ends in any way. If
/// a path exists and no process holds its claim, the process that created the path has ended. Works between
/// processes of one network namespace, for all users.
class Claim {
 public:
  explicit Claim(const std::string& path);

  /// Returns false if another process holds the claim.
  [[nodiscard]] bool held() const { return socket_.is_open(); }

 private:
  FileDescriptor socket_;
};

}  // namespace ex9000::sim
