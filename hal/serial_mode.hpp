// The mode of a UART, for code that handles UARTs from outside: doubles, simulated lines, and ports.
#pragma once

#include <cstdint>

#include "firmware/model/line_format.hpp"

namespace ex9000::hal {

/// The rate in bits per second and the line format; a rate of 0: the UART is off.
struct SerialMode {
  std::uint32_t baud = 0;
  LineFormat format = LineFormat::k8N1;

  friend constexpr bool operator==(SerialMode a, SerialMode b) {
    return a.baud == b.baud && a.format == b.format;
  }
  friend constexpr bool operator!=(SerialMode a, SerialMode b) { return !(a == b); }
};

}  // namespace ex9000::hal
