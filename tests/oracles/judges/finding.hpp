// What a judge makes of the bytes that a module has heard.
#pragma once

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

struct Finding {
  enum class Kind {
    Nothing,    ///< no frame, or one whose check fails
    Foreign,    ///< for another module
    Request,    ///< for the module: it may answer once
    Broadcast,  ///< for every module: none answers
    HostOk,     ///< likewise, and it restarts the host watchdog
  };

  Kind kind = Kind::Nothing;
  Bytes frame{};           ///< without its check; lives until the judge is told of the next byte
  Microseconds first = 0;  ///< when its first byte was over
  Microseconds last = 0;   ///< when its last byte was over
  bool doubtful = false;   ///< the module may have seen other frames in these bytes
};

}  // namespace ex9000::judges
