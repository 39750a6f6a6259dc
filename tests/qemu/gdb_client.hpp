// The emulator's debug port.
#pragma once

#include <string>
#include <utility>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// GDB's remote protocol, as far as a test bench needs it. Nothing is acknowledged, which QEMU takes for
/// that. Nothing may be sent while the machine runs: it would stop wherever it is.
class GdbClient {
 public:
  explicit GdbClient(UnixSocket socket) : socket_(std::move(socket)) {}

  /// `packet` in its frame.
  static std::string framed(const std::string& packet);
  /// What `framed` has made, one behind the other in one piece: the last of them may set the machine going.
  void send(const std::string& packets) { socket_.send(packets); }
  /// The next packet, without its frame. Throws std::runtime_error if none comes for `kHang`.
  std::string receive();
  /// Takes what has come; whether a packet is there.
  bool has_packet();
  [[nodiscard]] const UnixSocket& socket() const { return socket_; }

 private:
  UnixSocket socket_;
  std::string received_;  ///< behind the last packet
};

}  // namespace ex9000::rig
