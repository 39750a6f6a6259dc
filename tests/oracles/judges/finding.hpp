// The result of a judge for the bytes that a module has received.
#pragma once

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

struct Finding {
  enum class Kind {
    Nothing,    ///< no frame, or a frame whose check is wrong
    Foreign,    ///< not for the module
    Request,    ///< for the module, which may reply once
    Broadcast,  ///< for every module; none replies
    HostOk,     ///< for this or for every module; none replies, and each receiver restarts its host watchdog
  };

  Kind kind = Kind::Nothing;
  Bytes frame{};  ///< without its check; valid until the judge receives the next byte
  /// The time of the report of its first byte; in Modbus, of the first byte since the last silence.
  Microseconds first = 0;
  Microseconds last = 0;  ///< time of the report of its last byte
  bool doubtful = false;  ///< the module may have seen other frames in these bytes
};

}  // namespace ex9000::judges
