// The CRC-32 of the stored settings and of the entries in a flash (hal/flash/entry.hpp).
#pragma once

#include <array>
#include <cstdint>

namespace ex9000 {

/// The remainders of all values of four bits. Crc32 uses them to process a byte in two steps.
class Crc32Remainders {
 public:
  static constexpr unsigned kBits = 4;

  constexpr Crc32Remainders() {
    constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320;
    for (std::uint32_t value = 0; value < remainders_.size(); ++value) {
      std::uint32_t remainder = value;
      for (unsigned bit = 0; bit < kBits; ++bit) {
        remainder = (remainder & 1U) != 0 ? (remainder >> 1U) ^ kReflectedPolynomial : remainder >> 1U;
      }
      remainders_[value] = remainder;
    }
  }

  /// Returns the remainder of the lowest four bits of `value`.
  [[nodiscard]] constexpr std::uint32_t of(std::uint32_t value) const {
    return remainders_[value % remainders_.size()];
  }

 private:
  std::array<std::uint32_t, 1U << kBits> remainders_{};
};
inline constexpr Crc32Remainders kCrc32Remainders;

/// Computes the CRC-32 of IEEE 802.3, 3.2.9. It uses a table because a module with a page store computes up
/// to about 1,100 CRCs before its first reply (hal/flash/page_store.hpp).
class Crc32 {
 public:
  constexpr void add(std::uint8_t byte) {
    crc_ ^= byte;
    step();
    step();
  }

  [[nodiscard]] constexpr std::uint32_t value() const { return ~crc_; }

 private:
  constexpr void step() { crc_ = (crc_ >> Crc32Remainders::kBits) ^ kCrc32Remainders.of(crc_); }

  std::uint32_t crc_ = 0xFFFF'FFFF;
};

}  // namespace ex9000
