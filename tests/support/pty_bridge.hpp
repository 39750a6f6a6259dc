// Connects a module to a pseudo-terminal, for masters that require a serial port.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace ex9000::system {

/// A gateway for Modbus RTU masters. It reads a whole request from the terminal, sends the request to the
/// module, and returns the whole reply in one piece. Therefore gaps between the bytes of a request have no
/// effect on the module. For example, the operating system can interrupt the master and so cause a gap. A
/// request ends with the first byte at which its CRC is correct.
///
/// No other thread may use the module between a request and its reply. The baud rate of the terminal has no
/// effect.
class PtyBridge {
 public:
  using Bytes = std::vector<std::uint8_t>;

  /// `exchange` sends a request to the module and returns the reply. A thread of the bridge calls `exchange`.
  explicit PtyBridge(std::function<Bytes(const Bytes&)> exchange);
  ~PtyBridge();
  PtyBridge(const PtyBridge&) = delete;
  PtyBridge& operator=(const PtyBridge&) = delete;

  /// Returns the path of the master's end.
  [[nodiscard]] const std::string& tty() const { return tty_; }
  /// Stops the bridge. Then throws the error that `exchange` has thrown, if any. Throws std::runtime_error if
  /// the terminal has not accepted a reply.
  void end();

 private:
  void carry();
  void take(std::uint8_t byte);

  std::function<Bytes(const Bytes&)> exchange_;
  int fd_;
  int held_open_ = -1;  ///< prevents a hang-up when a master disconnects
  int over_;            ///< an event descriptor, readable when the bridge must stop
  std::string tty_;
  Bytes request_;
  std::exception_ptr failure_;
  std::thread carrier_;
};

}  // namespace ex9000::system
