// Constant tables whose length the compiler counts.
#pragma once

#include <array>
#include <cstddef>

namespace ex9000 {

/// Builds an array from rows: `table<Row>({{...}, {...}})`. The compiler counts the rows. A std::array with a
/// deduced size cannot replace this function, because GCC 12 puts such an array into writable memory.
template <class Row, std::size_t size>
constexpr std::array<Row, size> table(const Row (&rows)[size]) {
  std::array<Row, size> result{};
  for (std::size_t i = 0; i < size; ++i) {
    result[i] = rows[i];
  }
  return result;
}

}  // namespace ex9000
