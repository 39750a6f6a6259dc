// The line control register of a PL011 (UARTLCR_H), for models of the register and for tests that read the
// register of an emulated UART. Source: Arm PrimeCell UART (PL011) TRM, 3.3.7.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/model/line_format.hpp"

namespace ex9000 {

/// Returns the line format that `line_control` selects; nullopt for a format that modules do not have, for
/// example 7 data bits. Ignores FEN, the bit that enables the FIFOs.
constexpr std::optional<LineFormat> line_format_of(std::uint32_t line_control) {
  constexpr std::uint32_t kFifosOn = 1U << 4U;
  switch (line_control & ~kFifosOn) {
    case 0x60:  // WLEN: 8 bits
      return LineFormat::k8N1;
    case 0x68:  // STP2
      return LineFormat::k8N2;
    case 0x66:  // PEN, EPS
      return LineFormat::k8E1;
    case 0x62:  // PEN
      return LineFormat::k8O1;
    default:
      return std::nullopt;
  }
}

}  // namespace ex9000
