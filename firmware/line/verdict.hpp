// What a received byte brought.
#pragma once

#include <cstdint>

namespace ex9000 {

/// What the UART says of a byte.
enum class ByteStatus : std::uint8_t { Good, FramingError, Break, Overrun };

/// What became of the frame that a byte or a silence ended. Only Accepted reaches the main loop; to all
/// others the module stays silent. Frames with a right check come first.
enum class Verdict : std::uint8_t {
  Open,       ///< no frame ended
  Accepted,   ///< for this module or a broadcast, its check is right: it waits in the queue
  HostOk,     ///< the host says that it is alive; noted at once, so that it is never lost
  Foreign,    ///< right, but for another address
  NoRoom,     ///< would have been accepted, but one frame is waiting already
  BadCheck,   ///< wrong or missing checksum, wrong CRC
  TooShort,   ///< cannot hold an address and a check
  TooLong,    ///< longer than any frame may be
  LineError,  ///< a byte came with a framing, break or overrun error
  Overrun,    ///< a byte was lost because the one before was not taken in time
};

}  // namespace ex9000
