// What a judge makes of the bytes that a module has heard.
#pragma once

#include "firmware/bytes.hpp"
#include "tests/fuzz/lean_module.hpp"

namespace ex9000::fuzz {

struct Finding {
  enum class Kind {
    Nothing,
    Request,    ///< for the module: it may answer once
    Broadcast,  ///< for every module: none answers
    HostOk,     ///< likewise, and it restarts the host watchdog
  };

  Kind kind = Kind::Nothing;
  Bytes frame{};           ///< without its check; lives until the judge is told of the next byte
  Microseconds first = 0;  ///< when its first byte was over
  Microseconds last = 0;   ///< when its last byte was over
};

}  // namespace ex9000::fuzz
