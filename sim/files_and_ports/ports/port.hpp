// Carries bytes between real masters and the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace ex9000::sim {

/// None of the functions blocks. Only one thread at a time uses a port: the thread that runs the io_context
/// of the line, or the main thread during a pause (see LineThreads).
class Port {
 public:
  /// Positions of bytes, in ascending order.
  using Positions = std::vector<std::size_t>;
  /// Identifies a master that can leave while its bytes wait; null for any other master. A pointer that is
  /// never dereferenced.
  using Sender = const void*;
  using Left = std::function<void(Sender sender)>;
  /// Receives bytes that have arrived, the positions of those with wrong parity or a framing error, and their
  /// sender.
  /// Returns false if the port must wait for `resume` before it delivers more bytes of the master that has
  /// sent these bytes.
  using Received = std::function<bool(const std::uint8_t* bytes, std::size_t size, const Positions& damaged,
                                      Sender sender)>;

  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Starts to deliver bytes: calls `received` while the io_context runs. Call this once.
  virtual void start(Received received) = 0;
  /// Sets a function to call when a master has left, so that no more of its bytes need to be sent. Only TCP
  /// reports this: the bytes of a program that has closed a pseudo-terminal are sent, as by a serial port.
  virtual void on_left(const Left& /*left*/) {}
  /// Continues to deliver bytes after `received` has returned false.
  virtual void resume() = 0;
  /// Before this function returns, it passes all bytes that have arrived to `received`, except the bytes of
  /// masters that must wait for `resume`. The io_context does not have to run. Call this only after `start`.
  /// Only stepped time uses this function. For a serial port it does nothing, because stepped time cannot use
  /// serial ports.
  virtual void read_waiting() {}

  /// Sends bytes from the line to each master that has the port open; if there is none, the bytes are lost.
  /// Returns how many bytes the port has dropped because a master has it open and does not read. If the port
  /// has dropped bytes for several masters, returns the largest number for one master. A serial port returns
  /// the number of bytes for which the kernel has had no room since the previous call.
  virtual std::size_t send(const std::vector<std::uint8_t>& bytes) = 0;
  /// Call this when a station that is not the master has turned off its driver. No more bytes of the reply
  /// of this station follow.
  virtual void sent() {}

  /// Returns the rate of this port, in bits per second; nullopt if masters cannot set a rate at this port, or
  /// if the rate is 0.
  [[nodiscard]] virtual std::optional<std::uint32_t> baud() const { return std::nullopt; }
  /// Returns whether the port is connected to a real line. If it is, the transmission time of the bytes has
  /// already passed when they arrive.
  [[nodiscard]] virtual bool is_a_line() const { return false; }
};

}  // namespace ex9000::sim
