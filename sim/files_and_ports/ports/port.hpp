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
  /// In ascending order.
  using Positions = std::vector<std::size_t>;
  /// Identifies a master that can leave while its bytes wait, else null. Never dereferenced.
  using Sender = const void*;

  Arrivals() = default;
  Arrivals(const Arrivals&) = delete;
  Arrivals& operator=(const Arrivals&) = delete;
  virtual ~Arrivals() = default;

  /// `damaged`: wrong parity or a framing error. false: no more bytes of this sender before `resume`.
  virtual bool bytes(const Port& port, Bytes bytes, const Positions& damaged, Sender sender) = 0;
  /// Bytes that a gateway turns into requests. Calls `process` exactly once, now or later, when the line has
  /// reached its present time. false: no more before `resume`.
  virtual bool requests(std::size_t size, std::function<void()> process) = 0;
  /// A master has left: its bytes need not be sent. Only TCP reports this; the bytes of a program that has
  /// closed a pseudo-terminal are sent, as by a serial port.
  virtual void left(Sender /*sender*/) {}
  /// The first master has connected to a port that line time waits for.
  virtual void connected() {}
};

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
  /// Once. Delivers to `arrivals` while the io_context runs, and in `read_waiting`.
  virtual void start(Arrivals& arrivals) = 0;
  /// After `arrivals` has returned false.
  virtual void resume() = 0;
  /// Delivers all that has arrived, except from masters that must wait for `resume`; does not need the
  /// io_context. Only after `start`, and only in stepped time, which cannot use serial ports.
  virtual void read_waiting() {}

  /// To each master that has the port open. Returns how many bytes are dropped because such a master does not
  /// read, at most for one master; a serial port, for how many the kernel had no room since the last call.
  virtual std::size_t send(const std::vector<std::uint8_t>& bytes) = 0;
  /// A station other than the master has turned off its driver: its reply is complete.
  virtual void sent() {}

  /// In bits per second; nullopt: masters cannot set a rate here, or it is 0.
  [[nodiscard]] virtual std::optional<std::uint32_t> baud() const { return std::nullopt; }
  /// A real line: the transmission time of bytes has already passed when they arrive.
  [[nodiscard]] virtual bool is_a_line() const { return false; }

  /// Line time waits until a master has connected here.
  void hold_line() { holds_line_ = true; }
  [[nodiscard]] bool holds_line() const { return holds_line_; }

 protected:
  /// When a master has connected, before its first bytes.
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
