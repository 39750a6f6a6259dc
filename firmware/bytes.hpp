// Views of bytes, which they do not own.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ex9000 {

/// Read-only; the owner of the bytes says how long a view is valid.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  [[gnu::always_inline]] constexpr std::uint8_t operator[](std::size_t index) const { return data[index]; }
  /// Empty if `offset` is at or after the end.
  [[nodiscard, gnu::always_inline]] constexpr Bytes from(std::size_t offset) const {
    return offset < size ? Bytes{data + offset, size - offset} : Bytes{};
  }
  [[nodiscard, gnu::always_inline]] constexpr Bytes first(std::size_t count) const {
    return {data, count < size ? count : size};
  }
  [[nodiscard]] constexpr const std::uint8_t* begin() const { return data; }
  [[nodiscard]] constexpr const std::uint8_t* end() const { return data + size; }

  /// High byte first, as in Modbus. The range is not checked.
  [[nodiscard, gnu::always_inline]] constexpr std::uint16_t word(std::size_t offset) const {
    return static_cast<std::uint16_t>((data[offset] << 8U) | data[offset + 1]);
  }
  [[nodiscard]] constexpr std::uint32_t double_word(std::size_t offset) const {
    constexpr unsigned kBitsOfAWord = 16;
    return std::uint32_t{word(offset)} << kBitsOfAWord | word(offset + 2);
  }
  /// Low byte first, as in stored settings. The range is not checked.
  [[nodiscard]] constexpr std::uint16_t low_byte_first_16(std::size_t offset) const {
    return static_cast<std::uint16_t>(data[offset] | (data[offset + 1] << 8U));
  }
  [[nodiscard]] constexpr std::uint32_t low_byte_first_32(std::size_t offset) const {
    return low_byte_first_16(offset) | (std::uint32_t{low_byte_first_16(offset + 2)} << 16U);
  }
};

struct MutableBytes {
  std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

}  // namespace ex9000
