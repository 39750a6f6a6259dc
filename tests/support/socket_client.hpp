// A TCP client on this machine.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::system {

class SocketClient {
 public:
  /// Connects to a port of this machine. Throws std::runtime_error if no program listens there.
  explicit SocketClient(std::uint16_t port);
  ~SocketClient();
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;

  void send(const std::vector<std::uint8_t>& bytes);
  void send(const std::string& text) { send(std::vector<std::uint8_t>(text.begin(), text.end())); }
  /// Closes the sending direction. The client can still receive.
  void close_writing();
  /// Closes the connection with a TCP reset (RST). Call no other function after this one.
  void abort();
  /// Receives at least `count` bytes and returns all received bytes. Returns fewer bytes if the other side
  /// closes the connection, or if no byte arrives for 60 s. This timeout only detects a program that hangs.
  std::vector<std::uint8_t> receive(std::size_t count);
  std::string receive_text(std::size_t count);
  /// Waits until bytes arrive and returns them. Returns an empty vector if no byte arrives within `patience`,
  /// or if the other side closes the connection.
  std::vector<std::uint8_t> receive_some(std::chrono::milliseconds patience);
  bool hears_nothing_for(std::chrono::milliseconds time);
  /// Returns whether the other side closes the connection within 60 s. Returns false if there is still a byte
  /// to read before the end of the connection.
  bool closed();

 private:
  int fd_;
};

}  // namespace ex9000::system
