// Opens the pseudo-terminal of a simulator or of an emulator, as a terminal program does.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::system {

class Terminal {
 public:
  /// Opens `tty` in raw mode at `baud` bits per second. Throws std::runtime_error if that fails. `baud` must
  /// be a rate that cfsetspeed knows.
  Terminal(const std::string& tty, std::uint32_t baud);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void set_baud(std::uint32_t baud);
  /// Sets the rate and even parity, and CLOCAL as pyserial and libmodbus do. Returns false if that fails. A
  /// pseudo-terminal drops the parity.
  bool set_even_parity(std::uint32_t baud);
  /// Sets any rate; see system::set_any_rate. Throws std::runtime_error if that fails.
  void set_any_rate(std::uint32_t baud);
  /// Writes all bytes with one system call. Throws std::runtime_error if that fails.
  void write(const std::vector<std::uint8_t>& bytes);
  void type(const std::string& text);
  /// Waits until bytes arrive, and returns up to 4096 of them. Returns an empty vector if no byte arrives
  /// within `patience`, in real time. Throws std::runtime_error if the bytes cannot be read.
  std::vector<std::uint8_t> read(std::chrono::nanoseconds patience);
  /// Reads until the last received byte is a CR, and returns all bytes. If no more bytes arrive within
  /// `patience`, returns the bytes that have arrived. The default is only a limit for a program that hangs. A
  /// reply takes less than a second, or a few seconds on a busy machine.
  std::string read_line(std::chrono::milliseconds patience = std::chrono::seconds(60));
  /// Returns the number of bytes that have been read so far.
  [[nodiscard]] std::uint64_t received() const { return received_; }

 private:
  int fd_;
  std::uint64_t received_ = 0;
};

}  // namespace ex9000::system
