// A TCP client on this machine.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::system {

class SocketClient {
 public:
  /// Throws std::runtime_error where nobody listens.
  explicit SocketClient(std::uint16_t port);
  ~SocketClient();
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;

  void send(const std::vector<std::uint8_t>& bytes);
  void send(const std::string& text) { send(std::vector<std::uint8_t>(text.begin(), text.end())); }
  /// Says that nothing more will come, and listens on.
  void close_writing();
  /// Goes at once, with a reset, as a program that crashes; nothing can be done with it any more.
  void abort();
  /// What comes until `count` bytes are there, nothing came for 60 s, which only a program that hangs takes,
  /// or the other side has closed.
  std::vector<std::uint8_t> receive(std::size_t count);
  std::string receive_text(std::size_t count);
  /// What is there as soon as there is something; empty: nothing came for `patience`.
  std::vector<std::uint8_t> receive_some(std::chrono::milliseconds patience);
  bool hears_nothing_for(std::chrono::milliseconds time);
  /// Whether the other side has closed; waits 60 s for it.
  bool closed();

 private:
  int fd_;
};

}  // namespace ex9000::system
