// How a fuzz target says that a property does not hold.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace ex9000::fuzz {

/// Aborts, so that libFuzzer keeps the input, where `holds` is false; `claim` is printed.
inline void require(bool holds, const char* claim) {
  if (!holds) {
    std::fprintf(stderr, "does not hold: %s\n", claim);
    std::abort();
  }
}

}  // namespace ex9000::fuzz
