// Functions that the compiler calls to copy, fill and compare memory. A freestanding program must define them
// itself (GCC manual, "Language Standards Supported by GCC"). These functions process one byte at a time,
// because an image copies little data.
#include <cstddef>

// The compiler may recognise a loop, for example as a copy, and replace the loop with a call of memcpy. In an
// image, memcpy would then call itself endlessly. The options of the images forbid such calls
// (boards/CMakeLists.txt). memory_functions_test.cpp is compiled without these options. There, the attribute
// `optimize` makes GCC keep the loops. If GCC replaced the loops with calls, the test would test the
// functions of the C library. Clang ignores this attribute.
// `externally_visible` keeps the functions in an image that is compiled with -fwhole-program.
#define NO_SELF_CALL __attribute__((optimize("no-tree-loop-distribute-patterns"), externally_visible))

extern "C" {

NO_SELF_CALL void* memcpy(void* destination, const void* source, std::size_t size) {
  auto* to = static_cast<unsigned char*>(destination);
  const auto* from = static_cast<const unsigned char*>(source);
  for (; size != 0; --size) {
    *to++ = *from++;
  }
  return destination;
}

NO_SELF_CALL void* memmove(void* destination, const void* source, std::size_t size) {
  auto* to = static_cast<unsigned char*>(destination);
  const auto* from = static_cast<const unsigned char*>(source);
  if (to <= from) {
    return memcpy(destination, source, size);
  }
  while (size != 0) {
    --size;
    to[size] = from[size];
  }
  return destination;
}

NO_SELF_CALL void* memset(void* destination, int value, std::size_t size) {
  auto* to = static_cast<unsigned char*>(destination);
  for (; size != 0; --size) {
    *to++ = static_cast<unsigned char>(value);
  }
  return destination;
}

NO_SELF_CALL int memcmp(const void* a, const void* b, std::size_t size) {
  const auto* left = static_cast<const unsigned char*>(a);
  const auto* right = static_cast<const unsigned char*>(b);
  for (; size != 0; --size, ++left, ++right) {
    if (*left != *right) {
      return *left < *right ? -1 : 1;
    }
  }
  return 0;
}

}  // extern "C"
