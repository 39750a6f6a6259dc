// The interface to a terminal that shows the modules.
#pragma once

#include <cstddef>
#include <string>

namespace ex9000::sim {

struct Screen {
  std::size_t rows = 24;
  std::size_t columns = 80;
  bool utf8 = false;

  friend bool operator==(const Screen& a, const Screen& b) {
    return a.rows == b.rows && a.columns == b.columns && a.utf8 == b.utf8;
  }
};

class Terminal {
 public:
  Terminal() = default;
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  virtual ~Terminal() = default;

  /// Returns the present properties of the screen.
  [[nodiscard]] virtual Screen screen() const = 0;
  /// Writes `text`. Blocks only if the terminal accepts output too slowly.
  virtual void write(const std::string& text) = 0;
  /// Returns whether the terminal has accepted everything that `write` got.
  virtual bool keeps_up() = 0;
};

}  // namespace ex9000::sim
