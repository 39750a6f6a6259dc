// A master's end of a pseudo-terminal, as terminal programs have it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::system {

class Terminal {
 public:
  /// Opens `tty` raw at `baud`; throws std::runtime_error.
  Terminal(const std::string& tty, std::uint32_t baud);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void set_baud(std::uint32_t baud);
  /// In one piece.
  void write(const std::vector<std::uint8_t>& bytes);
  void type(const std::string& text);
  /// What is there, or comes within `patience`; empty: nothing.
  std::vector<std::uint8_t> read(std::chrono::nanoseconds patience);
  /// Up to CR, or what has come before nothing came for `patience`: only a program that hangs takes 60 s.
  std::string read_line(std::chrono::milliseconds patience = std::chrono::seconds(60));
  /// Bytes that were read so far.
  [[nodiscard]] std::uint64_t received() const { return received_; }

 private:
  int fd_;
  std::uint64_t received_ = 0;
};

}  // namespace ex9000::system
