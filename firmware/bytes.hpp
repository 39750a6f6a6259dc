// Views of bytes. A view does not own its bytes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ex9000 {

/// Read-only view of `size` bytes. The owner of the bytes defines how long the view is valid.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  [[gnu::always_inline]] constexpr std::uint8_t operator[](std::size_t index) const { return data[index]; }
  /// Returns the bytes from `offset` to the end; empty if `offset` is at or after the end.
  [[nodiscard, gnu::always_inline]] constexpr Bytes from(std::size_t offset) const {
    return offset < size ? Bytes{data + offset, size - offset} : Bytes{};
  }
  [[nodiscard, gnu::always_inline]] constexpr Bytes first(std::size_t count) const {
    return {data, count < size ? count : size};
  }
  [[nodiscard]] constexpr const std::uint8_t* begin() const { return data; }
  [[nodiscard]] constexpr const std::uint8_t* end() const { return data + size; }

  /// Returns the 16 bits at `offset`, high byte first (the Modbus byte order). Does not check the range.
  [[nodiscard, gnu::always_inline]] constexpr std::uint16_t word(std::size_t offset) const {
    return static_cast<std::uint16_t>((data[offset] << 8U) | data[offset + 1]);
  }
  /// Return the 16 or 32 bits at `offset`, low byte first (the byte order of stored settings). These
  /// functions do not check the range.
  [[nodiscard]] constexpr std::uint16_t low_byte_first_16(std::size_t offset) const {
    return static_cast<std::uint16_t>(data[offset] | (data[offset + 1] << 8U));
  }
  [[nodiscard]] constexpr std::uint32_t low_byte_first_32(std::size_t offset) const {
    return low_byte_first_16(offset) | (std::uint32_t{low_byte_first_16(offset + 2)} << 16U);
  }
};

/// Writable view of `size` bytes.
struct MutableBytes {
  std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

}  // namespace ex9000
