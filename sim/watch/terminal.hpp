// What a terminal can do for those who paint on it.
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

/// Where faces are painted.
class Terminal {
 public:
  Terminal() = default;
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  virtual ~Terminal() = default;

  /// As it is now.
  [[nodiscard]] virtual Screen screen() const = 0;
  /// Does not block as long as it keeps up.
  virtual void write(const std::string& text) = 0;
  /// Whether it has taken all that was written.
  virtual bool keeps_up() = 0;
};

}  // namespace ex9000::sim
