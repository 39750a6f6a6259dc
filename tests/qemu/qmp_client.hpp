// The emulator's monitor.
#pragma once

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
  /// Waits for this event. Throws std::runtime_error if nothing comes for `kHang`.
  void wait_for(const std::string& event);

 private:
  UnixSocket socket_;
};

}  // namespace ex9000::rig
