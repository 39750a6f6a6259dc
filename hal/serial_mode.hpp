// The mode of a UART, for code outside the firmware, for example hal/doubles and the simulator.
#pragma once

#include <cstdint>

#include "firmware/model/line_format.hpp"

namespace ex9000::hal {

/// A baud rate of 0, in bits per second: the UART is off.
struct SerialMode {
  std::uint32_t baud = 0;
  LineFormat format = LineFormat::k8N1;

  friend constexpr bool operator==(SerialMode a, SerialMode b) {
    return a.baud == b.baud && a.format == b.format;
  }
  friend constexpr bool operator!=(SerialMode a, SerialMode b) { return !(a == b); }
};

}  // namespace ex9000::hal
