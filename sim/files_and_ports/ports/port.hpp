// Carries bytes between real masters and the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/bytes.hpp"

namespace ex9000::sim {

class Port;

/// Takes what arrives at the ports of a line.
class Arrivals {
 public:
  /// Positions of bytes, in ascending order.
  using Positions = std::vector<std::size_t>;
  /// Identifies a master that can leave while its bytes wait; null for any other master. A pointer that is
  /// never dereferenced.
  using Sender = const void*;

  Arrivals() = default;
  Arrivals(const Arrivals&) = delete;
  Arrivals& operator=(const Arrivals&) = delete;
  virtual ~Arrivals() = default;

  /// Takes bytes for the line. `damaged`: those with wrong parity or a framing error. Returns false if the
  /// port must wait for `resume` before it delivers more bytes of this sender.
  virtual bool bytes(const Port& port, Bytes bytes, const Positions& damaged, Sender sender) = 0;
  /// Takes `size` bytes that a gateway turns into requests. Calls `process` exactly once, now or later, when
  /// the line has reached its present time. Returns false if the gateway must wait for `resume`.
  virtual bool requests(std::size_t size, std::function<void()> process) = 0;
  /// A master has left, so no more of its bytes need to be sent. Only TCP reports this: the bytes of a
  /// program that has closed a pseudo-terminal are sent, as by a serial port.
  virtual void left(Sender /*sender*/) {}
  /// The first master has connected to a port that line time waits for.
  virtual void connected() {}
};

/// What a user needs to reach a port.
struct PortSummary {
  std::string kind;     ///< as in --port: pty, tcp, modbus-tcp or serial
  std::string address;  ///< the path or HOST:PORT
  std::string does;     ///< for people, for example `pseudo-terminal plc.tty (/dev/pts/5)`
};

/// None of the functions blocks.
class Port {
 public:
  using Positions = Arrivals::Positions;
  using Sender = Arrivals::Sender;

  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  [[nodiscard]] virtual PortSummary summary() const = 0;
  /// Accepts masters, and delivers to `arrivals` while the io_context runs and during `read_waiting`. Call
  /// this once.
  virtual void start(Arrivals& arrivals) = 0;
  /// Continues to deliver after `arrivals` has returned false.
  virtual void resume() = 0;
  /// Delivers, before it returns, all that has arrived, except from masters that must wait for `resume`. The
  /// io_context does not have to run. Call this only after `start`. Only stepped time uses this function. For
  /// a serial port it does nothing, because stepped time cannot use serial ports.
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

  /// Makes line time wait until a master has connected to this port.
  void hold_line() { holds_line_ = true; }
  [[nodiscard]] bool holds_line() const { return holds_line_; }

 protected:
  /// Call this when a master has connected, before its first bytes.
  void let_line_go(Arrivals& arrivals) {
    if (holds_line_) {
      holds_line_ = false;
      arrivals.connected();
    }
  }

 private:
  bool holds_line_ = false;
};

}  // namespace ex9000::sim
