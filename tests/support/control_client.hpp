// A client of the simulator's control socket.
#pragma once

#include <cstddef>
#include <string>

namespace ex9000::system {

class ControlClient {
 public:
  /// Throws std::runtime_error where nobody listens at `path`.
  explicit ControlClient(const std::string& path);
  ~ControlClient();
  ControlClient(const ControlClient&) = delete;
  ControlClient& operator=(const ControlClient&) = delete;

  /// Sends a command and waits for its reply, without newline; throws where the simulator has gone.
  std::string ask(const std::string& command);
  /// What follows `ok `; throws where the reply is another.
  std::string ok(const std::string& command);
  /// Sends bytes as they are.
  void send(const std::string& bytes);
  /// Sends as much as goes without waiting for the simulator; how much that was.
  std::size_t offer(const std::string& bytes);
  /// Says that nothing more will come, and listens on.
  void close_writing();
  /// The next line, without newline; throws where the connection ends before.
  std::string line();
  /// Nothing comes any more.
  bool at_end();

 private:
  bool read_more();

  int fd_;
  std::string input_;
};

}  // namespace ex9000::system
