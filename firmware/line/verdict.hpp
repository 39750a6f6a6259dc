// Received bytes and frames: how the UART and the receiver judge them.
#pragma once

#include <cstdint>

namespace ex9000 {

enum class ByteStatus : std::uint8_t { Good, FramingError, ParityError, Break, Overrun };

/// On a frame that has ended. Only Accepted frames reach the main loop and can get a reply. The order must
/// not change: LineTallies counts ranges.
enum class Verdict : std::uint8_t {
  Open,       ///< no frame has ended, or an incomplete frame is dropped
  Accepted,   ///< correct, and for this module or for all modules; the frame is in the queue
  HostOk,     ///< a host OK; the interrupt stores its time, so that no host OK is lost
  Ignored,    ///< ASCII: a correct broadcast other than `#**` and `~**`
  Foreign,    ///< correct, but neither for this module nor for all modules, or an exception reply
  NoRoom,     ///< correct, and for this module or for all modules, but lost because another frame is waiting
  BadCheck,   ///< wrong or missing checksum, wrong CRC
  TooShort,   ///< ASCII with checksum: fewer than 3 characters; Modbus: fewer than 4 bytes
  TooLong,    ///< longer than the longest allowed frame
  LineError,  ///< a byte had a framing error, wrong parity or a break, or a gap was too long
  Overrun,    ///< a byte was lost because the previous byte was not read in time
};

}  // namespace ex9000
