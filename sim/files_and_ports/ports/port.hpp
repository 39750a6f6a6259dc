// Carries the bytes of a real master to the line and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace ex9000::sim {

/// No function blocks. Only one thread at a time uses a port: the thread that runs the io_context of the
/// line, or the main thread during a pause (see LineThreads).
class Port {
 public:
  /// Positions of bytes, in ascending order.
  using Positions = std::vector<std::size_t>;
  /// Receives the bytes that have arrived, and the positions of those with wrong parity. Returns false if the
  /// port must deliver no more until `resume`.
  using Received = std::function<bool(const std::uint8_t* bytes, std::size_t size, const Positions& damaged)>;

  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Call this once. `received` is called while the io_context runs.
  virtual void start(Received received) = 0;
  /// Continues to deliver bytes after `received` has returned false.
  virtual void resume() = 0;
  /// Calls `received` during this call for all bytes that have arrived, until `received` returns false; the
  /// io_context need not run. Call this only if `received` can accept more bytes. Only stepped time uses this
  /// function, so a serial port does not have it.
  virtual void read_waiting() {}

  /// Sends bytes from the line. The bytes are lost if no master has the port open, as on real wires. Returns
  /// how many bytes were dropped because a master has the port open and does not read.
  virtual std::size_t send(const std::vector<std::uint8_t>& bytes) = 0;
  /// Called when a station other than the master has turned its driver off, so that no more bytes of its
  /// reply follow.
  virtual void sent() {}

  /// Returns the rate that a master has set at this port, in bits per second; nullopt if the port has no rate
  /// or it is not a known rate.
  [[nodiscard]] virtual std::optional<std::uint32_t> baud() const { return std::nullopt; }
  /// Returns whether the port is a real line. If it is, the transmission time of the bytes has already passed
  /// when they arrive.
  [[nodiscard]] virtual bool is_a_line() const { return false; }
};

}  // namespace ex9000::sim
