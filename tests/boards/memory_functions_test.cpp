// Tests memcpy, memmove, memset and memcmp of an image. The compiler generates calls of these functions.
// memcpy, memmove and memset must write every byte of the requested range and no other byte. memcmp must
// compare only the requested bytes (C17, 7.24.2.1, 7.24.2.2, 7.24.4.1, 7.24.6.1).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// The functions are renamed because the test program already has those of the C library.
#define memcpy memcpy_of_the_image
#define memmove memmove_of_the_image
#define memset memset_of_the_image
#define memcmp memcmp_of_the_image
#include "boards/memory_functions.cpp"
#undef memcpy
#undef memmove
#undef memset
#undef memcmp

namespace {

constexpr std::size_t kSpace = 48;
constexpr std::size_t kMost = 40;
using Memory = std::array<std::uint8_t, kSpace>;

/// Returns bytes that all differ, so that a test detects a misplaced byte.
Memory some_bytes(unsigned seed) {
  Memory bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes.at(i) = static_cast<std::uint8_t>(seed + i);
  }
  return bytes;
}

TEST(MemoryFunctions, MemcpyCopiesExactlyTheRequestedBytesAtAnyAlignment) {
  for (std::size_t size = 0; size <= kMost; ++size) {
    for (std::size_t from = 0; from < 4; ++from) {
      for (std::size_t to = 0; to < 4; ++to) {
        const Memory source = some_bytes(1);
        Memory destination = some_bytes(101);
        Memory expected = destination;
        std::copy_n(source.begin() + from, size, expected.begin() + to);
        EXPECT_EQ(memcpy_of_the_image(&destination.at(to), &source.at(from), size), &destination.at(to));
        ASSERT_EQ(destination, expected) << size << " bytes from offset " << from << " to offset " << to;
      }
    }
  }
}

TEST(MemoryFunctions, MemmoveCopiesAlsoToAnOverlappingPlace) {
  constexpr std::size_t kSize = 20;
  for (std::size_t from = 0; from + kSize <= kSpace; ++from) {
    for (std::size_t to = 0; to + kSize <= kSpace; ++to) {
      const Memory before = some_bytes(1);
      Memory bytes = before;
      Memory expected = before;
      std::copy_n(before.begin() + from, kSize, expected.begin() + to);
      EXPECT_EQ(memmove_of_the_image(&bytes.at(to), &bytes.at(from), kSize), &bytes.at(to));
      ASSERT_EQ(bytes, expected) << "from offset " << from << " to offset " << to;
    }
  }
}

TEST(MemoryFunctions, MemsetSetsExactlyTheRequestedBytesToTheLowByteOfTheValue) {
  for (std::size_t size = 0; size <= kMost; ++size) {
    for (std::size_t at = 0; at < 4; ++at) {
      Memory bytes = some_bytes(101);
      Memory expected = bytes;
      std::fill_n(expected.begin() + at, size, 0xA5);
      EXPECT_EQ(memset_of_the_image(&bytes.at(at), 0x7FA5, size), &bytes.at(at));
      ASSERT_EQ(bytes, expected) << size << " bytes at offset " << at;
    }
  }
}

TEST(MemoryFunctions, MemcmpComparesOnlyTheRequestedBytes) {
  for (std::size_t size = 0; size < kMost; ++size) {
    const Memory left = some_bytes(1);
    Memory right = left;
    ++right.at(size);
    EXPECT_EQ(memcmp_of_the_image(left.data(), right.data(), size), 0) << size;
  }
}

TEST(MemoryFunctions, MemcmpComparesTheFirstDifferingBytesAsUnsigned) {
  for (std::size_t size = 1; size <= kMost; ++size) {
    for (std::size_t differs = 0; differs < size; ++differs) {
      Memory left = some_bytes(1);
      Memory right = left;
      left.at(differs) = 0x7F;
      right.at(differs) = 0x80;
      if (differs + 1 < size) {
        left.at(differs + 1) = 0xFF;  // the bytes after the first difference must not count
        right.at(differs + 1) = 0x00;
      }
      EXPECT_LT(memcmp_of_the_image(left.data(), right.data(), size), 0) << size << ", " << differs;
      EXPECT_GT(memcmp_of_the_image(right.data(), left.data(), size), 0) << size << ", " << differs;
    }
  }
}

}  // namespace
