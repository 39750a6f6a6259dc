// The terminal on standard output.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

namespace ex9000::sim {

struct Screen {
  std::size_t rows = 24;
  std::size_t columns = 80;
  bool utf8 = false;

  friend bool operator==(const Screen& a, const Screen& b) {
    return a.rows == b.rows && a.columns == b.columns && a.utf8 == b.utf8;
  }
};

/// Nothing: it is no terminal, or one without a cursor to place.
using ScreenOf = std::function<std::optional<Screen>()>;

/// Of this program's standard output, as it is now; does not block.
std::optional<Screen> screen_of_standard_output();

}  // namespace ex9000::sim
