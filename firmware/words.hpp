// Objects as the words they lie in, for comparing, merging and checking them a word at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace ex9000 {

/// 32 bits of any object (GCC and Clang: of whatever type it is).
using Word [[gnu::may_alias]] = std::uint32_t;

template <class T>
constexpr std::size_t kWordsOf = sizeof(T) / 4;

/// The words of `object`, which has no padding; kWordsOf<T> of them.
template <class T>
const Word* words_of(const T& object) {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) % 4 == 0 && alignof(T) >= 4);
  return reinterpret_cast<const Word*>(&object);
}
template <class T>
Word* words_of(T& object) {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) % 4 == 0 && alignof(T) >= 4);
  return reinterpret_cast<Word*>(&object);
}

inline bool same_words(const Word* a, const Word* b, std::size_t count) {
  for (; count != 0; --count) {
    if (*a++ != *b++) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
