// Waits until a file descriptor has room for more bytes.
#pragma once

#include <poll.h>

#include <cerrno>
#include <functional>

namespace ex9000::sim {

/// Returns whether to stop waiting for a reader, for example because a signal asks the program to end. May be
/// called on any thread; must not throw.
using GivesUp = std::function<bool()>;

/// Blocks until a write to `descriptor` would succeed or fail immediately, or until `gives_up` returns true.
/// Returns false in the last case.
inline bool wait_for_room(int descriptor, const GivesUp& gives_up) {
  // A signal that another thread receives does not interrupt poll(). Therefore poll() has a time limit, in
  // milliseconds, after which this function calls `gives_up` again.
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
