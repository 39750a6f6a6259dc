// A view of bytes that somebody else owns.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ex9000 {

/// Read-only view of `size` bytes; the owner says how long they live.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  [[gnu::always_inline]] constexpr std::uint8_t operator[](std::size_t index) const { return data[index]; }
  /// The bytes from `offset` on; none where there are no more.
  [[nodiscard, gnu::always_inline]] constexpr Bytes from(std::size_t offset) const {
    return offset < size ? Bytes{data + offset, size - offset} : Bytes{};
  }
  [[nodiscard, gnu::always_inline]] constexpr Bytes first(std::size_t count) const {
    return {data, count < size ? count : size};
  }
  [[nodiscard]] constexpr const std::uint8_t* begin() const { return data; }
  [[nodiscard]] constexpr const std::uint8_t* end() const { return data + size; }

  /// 16 bits at `offset`, high byte first as Modbus sends them.
  [[nodiscard, gnu::always_inline]] constexpr std::uint16_t word(std::size_t offset) const {
    return static_cast<std::uint16_t>((data[offset] << 8U) | data[offset + 1]);
  }
  /// 16 and 32 bits at `offset`, low byte first, as settings are stored.
  [[nodiscard]] constexpr std::uint16_t low_byte_first_16(std::size_t offset) const {
    return static_cast<std::uint16_t>(data[offset] | (data[offset + 1] << 8U));
  }
  [[nodiscard]] constexpr std::uint32_t low_byte_first_32(std::size_t offset) const {
    return low_byte_first_16(offset) | (std::uint32_t{low_byte_first_16(offset + 2)} << 16U);
  }
};

/// View of memory that somebody else fills.
struct MutableBytes {
  std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

}  // namespace ex9000
