// An EX9042D-M at address 01 and an EX9052D-M at address 02 on one line, for masters that require a serial
// port.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/simulator_process.hpp"

namespace ex9000::system {

/// How a master connects to the line, and the baud rate of the line.
struct Way {
  bool over_tcp;  ///< over socat, which connects a pseudo-terminal to a TCP port
  int baud;

  friend std::ostream& operator<<(std::ostream& out, const Way& way) {
    return out << (way.over_tcp ? "TCP" : "pty") << " at " << way.baud;
  }
};

class TwoModules {
 public:
  explicit TwoModules(Way way)
      : simulator_({"EX9042D-M@01,baud=" + std::to_string(way.baud),
                    "EX9052D-M@02,baud=" + std::to_string(way.baud), "--log",
                    way.over_tcp ? "--tcp=0" : "--pty=ex9000.tty"}) {
    if (way.over_tcp) {
      bridge_.emplace(
          std::vector<std::string>{"socat", "-d", "-d", "PTY,link=ex9000.tty,raw,echo=0",
                                   "TCP:127.0.0.1:" + std::to_string(simulator_.tcp_port()) + ",nodelay"},
          simulator_.directory(), ChildProcess::Errors::WithOutput);
      bridge_->wait_for("starting data transfer loop");
    }
  }

  [[nodiscard]] std::string tty() const { return simulator_.tty(); }
  SimulatorProcess& simulator() { return simulator_; }

 private:
  SimulatorProcess simulator_;
  std::optional<ChildProcess> bridge_;
};

}  // namespace ex9000::system
