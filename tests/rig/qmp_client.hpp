// The emulator's monitor.
#pragma once

#include <string>

#include "tests/rig/unix_socket.hpp"

namespace ex9000::rig {

/// QMP, as far as a test bench needs it: commands without arguments, and events by their names.
class QmpClient {
 public:
  /// Takes the greeting, which comes once the machine is complete.
  explicit QmpClient(UnixSocket socket);

  /// Returns when the emulator has accepted the command and `event` has come that says it is carried out.
  /// Throws std::runtime_error where it refuses.
  void execute(const std::string& command, const std::string& event);

 private:
  UnixSocket socket_;
};

}  // namespace ex9000::rig
