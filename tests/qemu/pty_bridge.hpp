// A module behind a pseudo-terminal, for masters that want a serial port.
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "tests/qemu/emulated_module.hpp"

namespace ex9000::rig {

/// Carries bytes both ways as long as it exists, without regard to rates; nobody else may use the module's
/// line meanwhile.
class PtyBridge {
 public:
  explicit PtyBridge(EmulatedModule& module);
  ~PtyBridge();
  PtyBridge(const PtyBridge&) = delete;
  PtyBridge& operator=(const PtyBridge&) = delete;

  /// The path of the master's end.
  [[nodiscard]] const std::string& tty() const { return tty_; }

 private:
  void carry();

  EmulatedModule& module_;
  int fd_;
  int held_open_ = -1;  ///< so that a master that leaves does not hang up the line
  std::string tty_;
  std::atomic<bool> over_{false};
  std::thread carrier_;
};

}  // namespace ex9000::rig
