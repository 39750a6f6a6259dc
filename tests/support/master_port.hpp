// The master's end of a port of the simulator. The port is a pseudo-terminal or a TCP connection.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/hang.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {

class MasterPort {
 public:
  MasterPort() = default;
  MasterPort(const MasterPort&) = delete;
  MasterPort& operator=(const MasterPort&) = delete;
  virtual ~MasterPort() = default;

  /// Sends `bytes`. Blocks until the kernel has accepted all of them. Throws std::runtime_error if that
  /// fails.
  virtual void write(const std::vector<std::uint8_t>& bytes) = 0;
  /// Blocks until bytes arrive and returns them. Throws std::runtime_error if the simulator closes the port,
  /// or if no bytes arrive within 60 s. This timeout only detects a simulator that hangs.
  virtual std::vector<std::uint8_t> read() = 0;
  /// Sets the baud rate. Returns false if the port has no baud rate.
  virtual bool set_baud(std::uint32_t rate) = 0;
};

class TerminalPort final : public MasterPort {
 public:
  explicit TerminalPort(const std::string& tty) : terminal_(tty, 9600) {}

  void write(const std::vector<std::uint8_t>& bytes) override { terminal_.write(bytes); }
  std::vector<std::uint8_t> read() override { return not_empty(terminal_.read(kHang)); }
  bool set_baud(std::uint32_t rate) override {
    terminal_.set_baud(rate);
    return true;
  }

  static std::vector<std::uint8_t> not_empty(std::vector<std::uint8_t> bytes) {
    if (bytes.empty()) {
      throw std::runtime_error(
          "no byte from the simulator has arrived within 60 s, or the simulator has closed the port");
    }
    return bytes;
  }

 private:
  Terminal terminal_;
};

class TcpPort final : public MasterPort {
 public:
  explicit TcpPort(std::uint16_t port) : client_(port) {}

  void write(const std::vector<std::uint8_t>& bytes) override { client_.send(bytes); }
  std::vector<std::uint8_t> read() override { return TerminalPort::not_empty(client_.receive_some(kHang)); }
  bool set_baud(std::uint32_t /*rate*/) override { return false; }

 private:
  SocketClient client_;
};

}  // namespace ex9000::system
