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

/// Frames of a bus scan and of access by serial number (extensions.md, scan): address, function, then one of
/// these.
constexpr std::uint8_t kScanAddress = 0xFD;
constexpr std::uint8_t kScanFunction = 0x46;
enum Scan : std::uint8_t {
  kFirstRound = 0x01,
  kNextRound = 0x02,
  kFound = 0x03,
  kNobodyLeft = 0x04,
  kRequestByNumber = 0x08,
  kReplyByNumber = 0x09,
};

/// A 0 in a window of an arbitration: one start bit; the rest is like silence, so that those of several
/// modules merge. No frame of a module begins so.
constexpr std::uint8_t kZeroInWindow = 0xFF;

/// In a frame by serial number: before the number, and before the request. The last byte of the number is
/// where the address of the request would be.
constexpr unsigned kNumberAt = 3;
constexpr unsigned kNumberPrefix = 6;

/// Function 03 or 04, register 0x3038, quantity 0 or 1; `frame` without CRC. The interrupt that ends a frame
/// checks this, so that no host OK is lost while a request is waiting.
constexpr bool is_host_ok(Bytes frame) {
  constexpr unsigned kSize = 6;
  return frame.size == kSize && (frame[1] == 0x03 || frame[1] == 0x04) && frame.word(2) == kHostOkRegister &&
         frame.word(4) <= 1;
}

}  // namespace ex9000::modbus
