// The result of a judge for the bytes that a module has received.
#pragma once

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

struct Finding {
  enum class Kind {
    Nothing,    ///< no new complete frame, or a frame that is spoiled or has a wrong length, CRC or checksum
    Foreign,    ///< for another module, or an ASCII broadcast other than `#**` and `~**`
    Request,    ///< for the module, which may reply once
    Broadcast,  ///< for every module; none replies
    HostOk,     ///< for this module or for every module; restarts the host watchdog; no reply
  };

  Kind kind = Kind::Nothing;
  Bytes frame{};  ///< without CRC, checksum and CR; valid until the judge receives the next byte
  /// In ASCII, the time of the report of the frame's first byte. In Modbus, the time of the report of the
  /// first byte after a silence or after a reply of the module; the frame may begin later.
  Microseconds first = 0;
  Microseconds last = 0;  ///< time of the report of the frame's last byte
  bool doubtful = false;  ///< the module may have found other frames in these bytes
};

}  // namespace ex9000::judges
