// An EX9042D-M at address 01 and an EX9052D-M at address 02 on one line, for masters that require a serial
// port or Modbus TCP.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/simulator_process.hpp"

namespace ex9000::system {

/// How a master connects to the line, and the baud rate of the line.
struct Way {
  enum Port {
    Pty,
    Tcp,        ///< over socat, which connects a pseudo-terminal to a TCP port
    ModbusTcp,  ///< over the simulator's Modbus TCP gateway, without a serial port
  };

  Port port;
  int baud;

  friend std::ostream& operator<<(std::ostream& out, const Way& way) {
    constexpr const char* kNames[] = {"pty", "TCP", "Modbus TCP"};
    return out << kNames[way.port] << " at " << way.baud;
  }
};

class TwoModules {
 public:
  explicit TwoModules(Way way)
      : simulator_({"EX9042D-M@01,baud=" + std::to_string(way.baud),
                    "EX9052D-M@02,baud=" + std::to_string(way.baud), "--log", option_of(way.port)}) {
    if (way.port == Way::Tcp) {
      bridge_.emplace(
          std::vector<std::string>{"socat", "-d", "-d", "PTY,link=ex9000.tty,raw,echo=0",
                                   "TCP:127.0.0.1:" + std::to_string(simulator_.tcp_port()) + ",nodelay"},
          simulator_.directory(), ChildProcess::Errors::WithOutput);
      bridge_->wait_for("starting data transfer loop");
    }
  }

  [[nodiscard]] std::string tty() const { return simulator_.tty(); }
  /// Requires Way::ModbusTcp.
  [[nodiscard]] std::uint16_t modbus_tcp_port() const { return simulator_.tcp_port(); }
  SimulatorProcess& simulator() { return simulator_; }

 private:
  static const char* option_of(Way::Port port) {
    switch (port) {
      case Way::Pty:
        return "--port=pty:ex9000.tty";
      case Way::Tcp:
        return "--port=tcp:0";
      case Way::ModbusTcp:
        break;
    }
    return "--port=modbus-tcp:0";
  }

  SimulatorProcess simulator_;
  std::optional<ChildProcess> bridge_;
};

}  // namespace ex9000::system
