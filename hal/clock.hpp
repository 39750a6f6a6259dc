#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// Free-running time. Wraps; see Time.
class Clock {
 public:
  /// Never blocks; interrupts and main loop may call it. Never goes back.
  [[nodiscard]] virtual Time now() const = 0;

 protected:
  ~Clock() = default;
};

}  // namespace ex9000::hal
