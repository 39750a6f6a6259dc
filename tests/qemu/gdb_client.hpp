// A client of the emulator's debug port.
#pragma once

#include <string>
#include <utility>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// The parts of GDB's remote protocol that the test bench requires. The client does not acknowledge packets;
/// QEMU accepts this. Do not send while the machine runs: the machine would stop immediately. The functions
/// that send or receive throw std::runtime_error if the emulator closes the connection.
class GdbClient {
 public:
  explicit GdbClient(UnixSocket socket) : socket_(std::move(socket)) {}

  /// Returns `packet` between `$` and `#`, followed by its checksum.
  static std::string framed(const std::string& packet);
  /// Sends one or more results of `framed`, concatenated. Only the last packet may start the machine.
  void send(const std::string& packets) { socket_.send(packets); }
  /// Returns the next packet without `$`, `#` and the checksum. Also throws std::runtime_error if the
  /// emulator sends nothing for `kHang`.
  std::string receive();
  /// Reads the bytes that have arrived. Returns whether `receive` can return a packet immediately. Does not
  /// block.
  bool has_packet();
  [[nodiscard]] const UnixSocket& socket() const { return socket_; }

 private:
  UnixSocket socket_;
  std::string received_;  ///< received bytes after the last packet that `receive` has returned
};

}  // namespace ex9000::rig
