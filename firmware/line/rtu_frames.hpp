// Modbus as the interrupt that ends a frame knows it: "Send Host OK" (manuals, mapping tables; wire.md
// section 7) and the mark of an exception reply (Modbus Application Protocol V1.1b3, 7).
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"

namespace ex9000::modbus {

constexpr std::uint8_t kBroadcast = 0;
constexpr std::uint16_t kHostOkRegister = 0x3038;

/// In the function code of exception replies, never of a request.
constexpr std::uint8_t kExceptionFlag = 0x80;

/// Function 03 or 04, register 0x3038, quantity 0 or 1; `frame` without CRC. The interrupt that ends a frame
/// checks this, so that no host OK is lost while a request is waiting.
constexpr bool is_host_ok(Bytes frame) {
  constexpr unsigned kSize = 6;
  return frame.size == kSize && (frame[1] == 0x03 || frame[1] == 0x04) && frame.word(2) == kHostOkRegister &&
         frame.word(4) <= 1;
}

}  // namespace ex9000::modbus
