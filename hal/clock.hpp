#pragma once

#include "firmware/time.hpp"

namespace ex9000::hal {

/// Free-running time. Wraps; see Time.
class Clock {
 public:
  /// Never blocks; interrupts and main loop may call it. Never goes back.
  [[nodiscard]] virtual Time now() const = 0;
  /// The same for interrupts that the clock's own does not interrupt, which may spare them something.
  [[nodiscard]] virtual Time now_in_interrupt() const { return now(); }

 protected:
  ~Clock() = default;
};

}  // namespace ex9000::hal
