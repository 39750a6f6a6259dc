// The CRC-32 of the stored settings and of images: IEEE 802.3, 3.2.9.
#pragma once

#include <array>
#include <cstdint>

namespace ex9000 {

namespace detail {

using Crc32Table = std::array<std::uint32_t, 16>;

/// The effect of each value of four bits on the CRC. A table for bytes would take 1 KB.
constexpr Crc32Table make_crc32_table() {
  constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320;
  Crc32Table table{};
  for (std::uint32_t bits = 0; bits < table.size(); ++bits) {
    std::uint32_t crc = bits;
    for (int bit = 0; bit < 4; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
    }
    table[bits] = crc;
  }
  return table;
}

inline constexpr Crc32Table kCrc32Table = make_crc32_table();

}  // namespace detail

class Crc32 {
 public:
  constexpr void add(std::uint8_t byte) {
    crc_ ^= byte;
    add_half();
    add_half();
  }

  [[nodiscard]] constexpr std::uint32_t value() const { return ~crc_; }

 private:
  constexpr void add_half() { crc_ = (crc_ >> 4U) ^ detail::kCrc32Table[crc_ & 0xFU]; }

  std::uint32_t crc_ = 0xFFFF'FFFF;
};

}  // namespace ex9000
