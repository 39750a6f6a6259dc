// Accesses the pins, the registers and the memory of the emulated microcontroller from outside, even while it
// runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/qemu/unix_socket.hpp"

namespace ex9000::rig {

/// QEMU's qtest protocol: one line for each command and each reply. All functions that send a command throw
/// std::runtime_error if the emulator reports an error, closes the connection, or does not reply within
/// `kHang`.
class QtestClient {
 public:
  explicit QtestClient(UnixSocket socket);

  /// Reads the 32-bit word at this bus address. The read has the same side effects as one by the processor.
  std::uint32_t read(std::uint32_t address);
  /// Reads several words.
  std::vector<std::uint32_t> read(const std::vector<std::uint32_t>& addresses);
  /// Reads `size` bytes of memory.
  std::vector<std::uint8_t> read(std::uint32_t address, std::uint32_t size);
  void write(std::uint32_t address, std::uint32_t value);
  void write(std::uint32_t address, const std::vector<std::uint8_t>& bytes);
  /// Returns a command that writes a word, for `carry_out`.
  static std::string write_command(std::uint32_t address, std::uint32_t value);
  /// Sends all commands together and waits until the emulator has executed them.
  void carry_out(const std::string& commands);
  /// Sets `size` bytes of memory to `byte`.
  void fill(std::uint32_t address, std::uint32_t size, std::uint8_t byte);
  /// Sets the level of an input line of the device at `path` in QEMU's object tree. The emulator ends if the
  /// device has no line with this number.
  void set_input(const std::string& path, unsigned number, bool level);

 private:
  std::string reply();
  std::uint32_t value();

  UnixSocket socket_;
};

}  // namespace ex9000::rig
