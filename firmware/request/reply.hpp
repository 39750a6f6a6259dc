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

/// Room for the longest frame. No handler exceeds it: the longest reply is an echo of the longest request,
/// and all others are a fraction of that.
class Reply {
 public:
  void clear() { end_ = bytes_.data(); }

  [[gnu::noinline]] void put(std::uint8_t byte) { *end_++ = byte; }
  /// Several at once, where time counts.
  template <class... More>
  [[gnu::always_inline]] void put(std::uint8_t first, std::uint8_t second, More... more) {
    std::uint8_t* end = end_;
    *end++ = first;
    *end++ = second;
    ((*end++ = static_cast<std::uint8_t>(more)), ...);
    end_ = end;
  }
  void put(char character) { put(static_cast<std::uint8_t>(character)); }
  [[gnu::noinline]] void put(Bytes bytes) {
    for (const std::uint8_t byte : bytes) {
      put(byte);
    }
  }
  [[gnu::noinline]] void put(std::string_view text) {
    for (const char character : text) {
      put(character);
    }
  }
  /// Two upper-case hex digits.
  [[gnu::noinline]] void put_hex(unsigned value) { put(hex_digit(value >> 4U), hex_digit(value)); }
  /// High byte first.
  [[gnu::noinline]] void put_word(unsigned value) {
    put(static_cast<std::uint8_t>(value >> 8U), static_cast<std::uint8_t>(value));
  }
  /// Overwrites a byte that was put before.
  void patch(std::size_t at, std::size_t value) { bytes_[at] = static_cast<std::uint8_t>(value); }

  [[nodiscard]] bool empty() const { return end_ == bytes_.data(); }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(end_ - bytes_.data()); }
  [[nodiscard]] Bytes bytes() const { return {bytes_.data(), size()}; }

 private:
  std::uint8_t* end_ = nullptr;  ///< behind what was put; from the first `clear` on
  std::array<std::uint8_t, kLongestFrame> bytes_{};
};

}  // namespace ex9000
