// The emulator's monitor.
#pragma once

#include <chrono>
#include <string>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// QMP, as far as a test bench needs it.
class QmpClient {
 public:
  /// Takes the greeting, which comes once the machine is complete.
  explicit QmpClient(UnixSocket socket);

  /// Returns when the emulator has accepted the command and `event` has come that says it is carried out.
  /// Throws std::runtime_error where it refuses.
  /// `arguments` are a JSON object.
  void execute(const std::string& command, const std::string& event, const std::string& arguments = "{}");
  /// Whether this event comes before nothing has come for `patience`.
  bool hears(const std::string& event, std::chrono::nanoseconds patience);

 private:
  UnixSocket socket_;
};

}  // namespace ex9000::rig
