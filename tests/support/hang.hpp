// The limit of waits for other programs.
#pragma once

#include <chrono>

namespace ex9000 {

/// A program that does nothing for this long hangs. A wait ends with an event; this limit only lets the test
/// fail if the event never comes.
inline constexpr std::chrono::seconds kHang{60};
inline constexpr int kHangMilliseconds = 60'000;

/// Evaluates `condition` until it is true. Returns false if that takes longer than kHang.
template <class Condition>
bool becomes_true(Condition condition) {
  const auto began = std::chrono::steady_clock::now();
  while (!condition()) {
    if (std::chrono::steady_clock::now() - began > kHang) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
