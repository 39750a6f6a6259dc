// What the interrupt that ends a frame knows of Modbus: the request "Send Host OK" (manuals, mapping tables;
// wire.md section 7), and the mark of an exception reply (Modbus Application Protocol V1.1b3, 7).
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"

namespace ex9000::modbus {

constexpr std::uint8_t kBroadcast = 0;
constexpr std::uint16_t kHostOkRegister = 0x3038;

/// Set in the function of an exception reply. A frame whose function has this bit is never a request.
constexpr std::uint8_t kExceptionFlag = 0x80;

/// Returns whether `frame`, which does not contain the CRC, is a host OK: function 03 or 04, register 0x3038,
/// quantity 0 or 1. The interrupt that ends a frame calls this, so that no host OK is lost while a request is
/// waiting.
constexpr bool is_host_ok(Bytes frame) {
  constexpr unsigned kSize = 6;
  return frame.size == kSize && (frame[1] == 0x03 || frame[1] == 0x04) && frame.word(2) == kHostOkRegister &&
         frame.word(4) <= 1;
}

}  // namespace ex9000::modbus
