// A client of the emulator's debug port.
#pragma once

#include <string>
#include <utility>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// The parts of GDB's remote protocol that the test bench requires. The client acknowledges no packet, which
/// QEMU accepts. Do not send while the machine runs: it would stop immediately.
class GdbClient {
 public:
  explicit GdbClient(UnixSocket socket) : socket_(std::move(socket)) {}

  /// Returns `packet` with its frame.
  static std::string framed(const std::string& packet);
  /// Sends packets from `framed`, concatenated, in one piece. The last one may start the machine.
  void send(const std::string& packets) { socket_.send(packets); }
  /// Returns the next packet, without its frame. Throws std::runtime_error if none arrives within `kHang`.
  std::string receive();
  /// Reads the received bytes without blocking. Returns whether a complete packet is there.
  bool has_packet();
  [[nodiscard]] const UnixSocket& socket() const { return socket_; }

 private:
  UnixSocket socket_;
  std::string received_;  ///< bytes after the last packet
};

}  // namespace ex9000::rig
