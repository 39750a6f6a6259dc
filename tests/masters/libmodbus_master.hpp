// A Modbus master that uses libmodbus, on a pseudo-terminal or over Modbus TCP.
#pragma once

#include <modbus/modbus.h>

#include <cerrno>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace ex9000::system {

class LibmodbusMaster {
 public:
  /// Response timeout in milliseconds, long enough for a busy machine.
  static constexpr unsigned kReplies = 10'000;

  LibmodbusMaster(const std::string& tty, int baud)
      : LibmodbusMaster(modbus_new_rtu(tty.c_str(), baud, 'N', 8, 1)) {}
  /// Connects to a Modbus TCP port of this machine.
  explicit LibmodbusMaster(std::uint16_t port) : LibmodbusMaster(modbus_new_tcp("127.0.0.1", port)) {}
  ~LibmodbusMaster() { modbus_close(context_.get()); }
  LibmodbusMaster(const LibmodbusMaster&) = delete;
  LibmodbusMaster& operator=(const LibmodbusMaster&) = delete;

  /// Sets the longest time from a request to the end of its reply. Disables the timeout of libmodbus for the
  /// time between two bytes (500 ms by default), because a busy machine can deliver a reply in pieces.
  void wait_for_replies(unsigned milliseconds) {
    modbus_set_byte_timeout(context_.get(), 0, 0);
    modbus_set_response_timeout(context_.get(), milliseconds / 1000, milliseconds % 1000 * 1000);
  }

  modbus_t* at(int address) {
    modbus_set_slave(context_.get(), address);
    return context_.get();
  }

 private:
  explicit LibmodbusMaster(modbus_t* context) : context_(context, modbus_free) {
    wait_for_replies(kReplies);
    if (modbus_connect(context_.get()) != 0) {
      throw std::runtime_error(modbus_strerror(errno));
    }
  }

  std::unique_ptr<modbus_t, void (*)(modbus_t*)> context_;
};

}  // namespace ex9000::system
