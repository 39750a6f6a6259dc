// A client of the emulator's monitor.
#pragma once

#include <string>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// The parts of QMP that the test bench requires.
class QmpClient {
 public:
  /// Reads the greeting, which the emulator sends when the machine is complete.
  explicit QmpClient(UnixSocket socket);

  /// Returns when the emulator has accepted the command and has sent `event`, which reports its completion.
  /// `arguments` is a JSON object. Throws std::runtime_error if the emulator rejects the command.
  void execute(const std::string& command, const std::string& event, const std::string& arguments = "{}");
  /// Waits for this event. Throws std::runtime_error if nothing arrives within `kHang`.
  void wait_for(const std::string& event);

 private:
  UnixSocket socket_;
};

}  // namespace ex9000::rig
