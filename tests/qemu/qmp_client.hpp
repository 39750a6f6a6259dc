// A client of the emulator's monitor.
#pragma once

#include <string>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// The parts of QEMU's monitor protocol (QMP) that the test bench requires. All functions throw
/// std::runtime_error if the emulator closes the connection or sends nothing for `kHang`.
class QmpClient {
 public:
  /// Reads the greeting, which the emulator sends when the machine is complete, and enables commands.
  explicit QmpClient(UnixSocket socket);

  /// Executes a command. `arguments` is a JSON object. Returns when the emulator has accepted the command and
  /// has sent `event`, which reports the completion of the command. If the reply itself reports the
  /// completion, `event` must be `return`. Also throws std::runtime_error if the emulator rejects the
  /// command.
  void execute(const std::string& command, const std::string& event, const std::string& arguments = "{}");
  /// Waits for this event.
  void wait_for(const std::string& event);

 private:
  UnixSocket socket_;
};

}  // namespace ex9000::rig
