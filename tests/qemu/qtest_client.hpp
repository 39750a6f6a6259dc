// Pins and registers of the emulated microcontroller, from outside, while it runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// QEMU's qtest protocol: a command a line, a reply a line.
class QtestClient {
 public:
  explicit QtestClient(UnixSocket socket);

  /// The 32-bit word at this bus address, with whatever reading it does.
  std::uint32_t read(std::uint32_t address);
  /// Several of them.
  std::vector<std::uint32_t> read(const std::vector<std::uint32_t>& addresses);
  /// So many bytes of memory.
  std::vector<std::uint8_t> read(std::uint32_t address, std::uint32_t size);
  void write(std::uint32_t address, std::uint32_t value);
  void write(std::uint32_t address, const std::vector<std::uint8_t>& bytes);
  /// Writes a word, as one of many commands for `carry_out`.
  static std::string write_command(std::uint32_t address, std::uint32_t value);
  /// All of them in one piece, and waits until they are done.
  void carry_out(const std::string& commands);
  /// Fills memory.
  void fill(std::uint32_t address, std::uint32_t size, std::uint8_t byte);
  /// Level of an input line of the device at `path`. A number it does not have ends the emulator.
  void set_input(const std::string& path, unsigned number, bool level);

 private:
  std::string reply();
  std::uint32_t value();

  UnixSocket socket_;
};

}  // namespace ex9000::rig
