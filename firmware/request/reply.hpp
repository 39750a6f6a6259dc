// The buffer in which handlers write a reply.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/hex.hpp"
#include "firmware/line/frame_queue.hpp"

namespace ex9000 {

/// Drops bytes beyond kLongestFrame. No reply is longer: the longest Modbus reply echoes the longest request,
/// and every DCON reply is shorter than 32 bytes.
class Reply {
 public:
  void clear() { size_ = 0; }

  void put(std::uint8_t byte) {
    if (size_ < bytes_.size()) {
      bytes_[size_] = byte;
      ++size_;
    }
  }
  void put(char character) { put(static_cast<std::uint8_t>(character)); }
  void put(Bytes bytes) {
    std::uint8_t* next = bytes_.data() + size_;
    const Bytes fitting = bytes.first(bytes_.size() - size_);
    for (const std::uint8_t byte : fitting) {
      *next++ = byte;
    }
    size_ += fitting.size;
  }
  void put(std::string_view text) {
    for (const char character : text) {
      put(character);
    }
  }
  /// The low byte, as two upper-case hex digits.
  void put_hex(unsigned value) {
    put(hex_digit(value >> 4U));
    put(hex_digit(value));
  }
  /// The low 16 bits, high byte first.
  void put_word(unsigned value) {
    put(static_cast<std::uint8_t>(value >> 8U));
    put(static_cast<std::uint8_t>(value));
  }
  /// Before all others; they must still fit.
  void put_first(Bytes bytes) {
    for (std::size_t i = size_; i != 0; --i) {
      bytes_[i - 1 + bytes.size] = bytes_[i - 1];
    }
    for (std::size_t i = 0; i < bytes.size; ++i) {
      bytes_[i] = bytes[i];
    }
    size_ += bytes.size;
  }
  /// The low byte of `value` replaces the byte at `at`; ignored if that is not written yet.
  void patch(std::size_t at, std::size_t value) {
    if (at < size_) {
      bytes_[at] = static_cast<std::uint8_t>(value);
    }
  }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Bytes bytes() const { return {bytes_.data(), size_}; }

 private:
  std::size_t size_ = 0;
  std::array<std::uint8_t, kLongestFrame> bytes_{};
};

}  // namespace ex9000
