// CHK of ASCII frames: wire.md 3.
#pragma once

#include <string>

#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::reference {

/// Returns two upper-case hex digits: the sum of all characters, modulo 256.
inline std::string check_of(const std::string& characters) {
  unsigned sum = 0;
  for (const char character : characters) {
    sum += static_cast<unsigned char>(character);
  }
  return hex(sum % 256, 2);
}

}  // namespace ex9000::reference
