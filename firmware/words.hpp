// Objects as the words or bytes they lie in, for comparing, merging and checking them a word at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace ex9000 {

/// `T` without padding, a whole number of 32-bit words.
template <class T>
std::array<std::uint32_t, sizeof(T) / 4> words_of(const T& object) {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) % 4 == 0);
  std::array<std::uint32_t, sizeof(T) / 4> words;
  __builtin_memcpy(&words, &object, sizeof words);  // std::memcpy, as the compiler itself knows it
  return words;
}

template <class T>
std::array<std::uint8_t, sizeof(T)> bytes_of(const T& object) {
  static_assert(std::is_trivially_copyable<T>::value);
  std::array<std::uint8_t, sizeof(T)> bytes;
  __builtin_memcpy(&bytes, &object, sizeof bytes);
  return bytes;
}

/// The object that lies in `image`, an array of words or bytes.
template <class T, class Image>
T object_in(const Image& image) {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) == sizeof(Image));
  T object;
  __builtin_memcpy(static_cast<void*>(&object), &image, sizeof object);
  return object;
}

}  // namespace ex9000
