// Who uses a path that a process leaves behind when it dies.
#pragma once

#include <string>

namespace ex9000::sim {

/// Held by one process at a time, and given up when it ends, however it ends: what stands at the path without
/// somebody holding this was left by a dead one. Among processes of one network namespace, whosever they are.
class Claim {
 public:
  explicit Claim(const std::string& path);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// False: another has it.
  [[nodiscard]] bool held() const { return fd_ >= 0; }

 private:
  int fd_;
};

}  // namespace ex9000::sim
