// Makes a fuzz target abort if a property does not hold.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace ex9000::fuzz {

/// If `holds` is false, prints `claim` and aborts, so that libFuzzer keeps the input.
inline void require(bool holds, const char* claim) {
  if (!holds) {
    std::fprintf(stderr, "does not hold: %s\n", claim);
    std::abort();
  }
}

}  // namespace ex9000::fuzz
