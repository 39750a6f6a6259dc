// A client of the simulator's control socket.
#pragma once

#include <cstddef>
#include <string>

namespace ex9000::system {

class ControlClient {
 public:
  /// Connects to the socket at `path`. Throws std::runtime_error if no program listens there.
  explicit ControlClient(const std::string& path);
  ~ControlClient();
  ControlClient(const ControlClient&) = delete;
  ControlClient& operator=(const ControlClient&) = delete;

  /// Sends a command and returns its reply without the newline. Throws std::runtime_error if the connection
  /// ends, or if nothing arrives for 60 s.
  std::string ask(const std::string& command);
  /// Sends a command and returns the text after `ok `. Throws std::runtime_error if the reply does not begin
  /// with `ok`, and in the same cases as `ask`.
  std::string ok(const std::string& command);
  /// Sends `bytes` unchanged; adds no newline. Throws std::runtime_error if the simulator has closed the
  /// connection.
  void send(const std::string& bytes);
  /// Sends as many bytes as possible without blocking. Returns the number of bytes sent.
  std::size_t offer(const std::string& bytes);
  /// Closes the sending direction. The client can still receive.
  void close_writing();
  /// Waits for the next line and returns it without the newline. Throws std::runtime_error if the connection
  /// ends before the newline, or if nothing arrives for 60 s.
  std::string line();
  /// Returns whether the simulator has closed the connection and all bytes from the simulator have been read.
  /// If there is no byte to read, first waits for a byte or for the end of the connection. Throws
  /// std::runtime_error if neither arrives within 60 s.
  bool at_end();

 private:
  bool read_more();

  int fd_;
  std::string input_;
};

}  // namespace ex9000::system
