// Tables whose length is that of their rows.
#pragma once

#include <array>
#include <cstddef>

namespace ex9000 {

/// `table<Row>({{...}, {...}})`: a row more is a line more, and no number to change. (What std::array deduces
/// by itself, GCC 12 puts in writable memory.)
template <class Row, std::size_t size>
constexpr std::array<Row, size> table(const Row (&rows)[size]) {
  std::array<Row, size> result{};
  for (std::size_t i = 0; i < size; ++i) {
    result[i] = rows[i];
  }
  return result;
}

}  // namespace ex9000
