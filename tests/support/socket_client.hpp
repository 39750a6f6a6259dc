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
  /// What comes until `count` bytes are there, nothing came for 10 s, or the other side has closed.
  std::vector<std::uint8_t> receive(std::size_t count);
  std::string receive_text(std::size_t count);
  bool hears_nothing_for(std::chrono::milliseconds time);
  /// Whether the other side has closed; waits 10 s for it.
  bool closed();

 private:
  int fd_;
};

}  // namespace ex9000::system
