// What an image finds in RAM before any of its code has run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

/// C++20's constinit: the compiler refuses an object that it cannot initialise by itself.
#ifdef __clang__
#define EX9000_CONSTINIT [[clang::require_constant_initialization]]
#else
#define EX9000_CONSTINIT __constinit
#endif

namespace ex9000 {

/// How many words of `object`, which nobody has touched since the program was loaded, are not 0.
template <class T>
std::size_t words_other_than_0(const T& object) {
  static_assert(sizeof(T) % sizeof(std::uintptr_t) == 0);
  std::size_t count = 0;
  for (std::size_t at = 0; at < sizeof object; at += sizeof(std::uintptr_t)) {
    std::uintptr_t word = 0;
    std::memcpy(&word, reinterpret_cast<const char*>(&object) + at, sizeof word);
    count += word != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace ex9000
