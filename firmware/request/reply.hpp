// The reply while it is being written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/hex.hpp"
#include "firmware/line/frame_queue.hpp"

namespace ex9000 {

/// Room for the longest frame, which no handler exceeds; if one did, it would spoil its own beginning and
/// nothing else.
class Reply {
  static_assert((kLongestFrame & (kLongestFrame - 1)) == 0, "an index is kept inside by a mask");

 public:
  void clear() { size_ = 0; }

  [[gnu::noinline]] void put(std::uint8_t byte) { bytes_[size_++ & (kLongestFrame - 1)] = byte; }
  void put(char character) { put(static_cast<std::uint8_t>(character)); }
  void put(Bytes bytes) {
    for (const std::uint8_t byte : bytes) {
      put(byte);
    }
  }
  void put(std::string_view text) {
    for (const char character : text) {
      put(character);
    }
  }
  /// Two upper-case hex digits.
  [[gnu::noinline]] void put_hex(unsigned value) {
    put(hex_digit(value >> 4U));
    put(hex_digit(value));
  }
  /// High byte first.
  [[gnu::noinline]] void put_word(unsigned value) {
    put(static_cast<std::uint8_t>(value >> 8U));
    put(static_cast<std::uint8_t>(value));
  }
  /// Overwrites a byte that was put before.
  void patch(std::size_t at, std::size_t value) { bytes_[at] = static_cast<std::uint8_t>(value); }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Bytes bytes() const { return {bytes_.data(), size_}; }

 private:
  std::array<std::uint8_t, kLongestFrame> bytes_{};
  std::uint16_t size_ = 0;
};

}  // namespace ex9000
