// A listening UNIX socket and its connection. The command line of the emulator contains the path of the
// socket, and the emulator connects to the socket.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/hang.hpp"

namespace ex9000::rig {

/// A connection. The functions that send or receive throw std::runtime_error on errors.
class UnixSocket {
 public:
  explicit UnixSocket(int fd) : fd_(fd) {}
  ~UnixSocket();
  UnixSocket(UnixSocket&& other) noexcept;
  UnixSocket& operator=(UnixSocket&&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  /// Sends all bytes. Blocks until the kernel has accepted all of them.
  void send(const std::uint8_t* bytes, std::size_t size);
  void send(const std::string& text);
  /// Waits until bytes arrive and returns them. Returns no bytes if none arrive within `patience`.
  std::vector<std::uint8_t> receive(std::chrono::nanoseconds patience);
  /// Receives exactly `size` bytes. Throws if no byte arrives for `kHang`.
  void receive_all(std::uint8_t* bytes, std::size_t size);
  /// Returns whether bytes are available or the other end has closed the connection. Does not block.
  [[nodiscard]] bool has_bytes() const;
  /// Returns the next line without its LF. Throws if no byte arrives for `kHang`.
  std::string receive_line();

 private:
  int fd_;
  std::string received_;  ///< received bytes after the last line that `receive_line` has returned
};

/// Waits until one of the sockets has bytes or has been closed by the other end. Returns false if this takes
/// longer than `kHang`.
bool wait_for_any(const std::vector<const UnixSocket*>& sockets);

/// Listens at a path for one connection. The constructor throws std::runtime_error if it cannot listen there.
class UnixListener {
 public:
  explicit UnixListener(const std::string& path);
  ~UnixListener();
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;

  /// Returns the connection; nullopt if the descriptor `ended` becomes readable first. Throws
  /// std::runtime_error if neither happens within `kHang`.
  std::optional<UnixSocket> accept(int ended);

 private:
  int fd_;
};

}  // namespace ex9000::rig
