// Pins and registers of the emulated microcontroller, from outside, while it runs.
#pragma once

#include <cstdint>
#include <string>

#include "tests/rig/unix_socket.hpp"

namespace ex9000::rig {

/// QEMU's qtest protocol: a command a line, a reply a line.
class QtestClient {
 public:
  explicit QtestClient(UnixSocket socket);

  /// The 32-bit word at this bus address, with whatever reading it does.
  std::uint32_t read(std::uint32_t address);
  void write(std::uint32_t address, std::uint32_t value);
  /// Fills memory.
  void fill(std::uint32_t address, std::uint32_t size, std::uint8_t byte);
  /// Level of an input line of the device at `path`. A number it does not have ends the emulator.
  void set_input(const std::string& path, unsigned number, bool level);
  /// The same, and then the word at `address`: one turn of the emulator less.
  std::uint32_t set_input_and_read(const std::string& path, unsigned number, bool level,
                                   std::uint32_t address);

 private:
  std::string reply();
  std::uint32_t value();

  UnixSocket socket_;
};

}  // namespace ex9000::rig
