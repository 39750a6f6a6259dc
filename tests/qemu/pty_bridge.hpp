// A module behind a pseudo-terminal, for masters that want a serial port.
#pragma once

#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "tests/qemu/timed_module.hpp"

namespace ex9000::rig {

/// A gateway for masters of Modbus RTU: takes a whole request from the terminal, plays it to the module in
/// the module's time, and hands the whole reply back in one piece. However the host's time tears what a
/// master writes, the module hears the same. A request ends with the first byte up to which its CRC is right.
///
/// Nobody else may use the module between a request and its reply. Rates of the terminal make no difference.
class PtyBridge {
 public:
  explicit PtyBridge(TimedModule& module);
  ~PtyBridge();
  PtyBridge(const PtyBridge&) = delete;
  PtyBridge& operator=(const PtyBridge&) = delete;

  /// The path of the master's end.
  [[nodiscard]] const std::string& tty() const { return tty_; }
  /// Ends it, and throws what the module has thrown meanwhile.
  void end();

 private:
  void carry();
  void take(std::uint8_t byte);

  TimedModule& module_;
  int fd_;
  int held_open_ = -1;  ///< so that a master that leaves does not hang up the line
  int over_;            ///< an event: readable when the bridge is to end
  std::string tty_;
  std::vector<std::uint8_t> request_;
  std::exception_ptr failure_;
  std::thread carrier_;
};

}  // namespace ex9000::rig
