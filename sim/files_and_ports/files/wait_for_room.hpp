// Waits until a file descriptor has room for more bytes.
#pragma once

#include <poll.h>

#include <cerrno>
#include <functional>

namespace ex9000::sim {

/// Whether to stop waiting for a reader, for example at a signal. On any thread; must not throw.
using GivesUp = std::function<bool()>;

/// Blocks until a write would succeed or fail at once; false: `gives_up` has returned true.
inline bool wait_for_room(int descriptor, const GivesUp& gives_up) {
  // In ms: a signal that another thread receives does not interrupt poll(), so ask `gives_up` again.
  constexpr int kAskEvery = 100;
  pollfd ready{descriptor, POLLOUT, 0};
  int result = poll(&ready, 1, 0);
  while (result == 0 || (result < 0 && errno == EINTR)) {
    if (gives_up()) {
      return false;
    }
    result = poll(&ready, 1, kAskEvery);
  }
  return true;
}

}  // namespace ex9000::sim
