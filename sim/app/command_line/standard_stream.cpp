#include "sim/app/command_line/standard_stream.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <stdexcept>
#include <utility>

#include "sim/text/system_error.hpp"

namespace ex9000::sim {

StandardStream::StandardStream(int file, std::string name, std::function<bool()> gives_up)
    : file_(file), name_(std::move(name)), gives_up_(std::move(gives_up)) {}

/// Writes at most PIPE_BUF bytes in each system call, because a pipe that has room accepts this number
/// without blocking.
bool StandardStream::write(const std::string& text) {
  for (std::size_t done = 0; done < text.size() && !ended_;) {
    if (!wait_for_room()) {
      ended_ = true;
      break;
    }
    const std::size_t piece = std::min<std::size_t>(text.size() - done, PIPE_BUF);
    const ssize_t written = ::write(file_, text.data() + done, piece);
    if (written >= 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno == EPIPE) {
      ended_ = true;
    } else if (errno != EINTR && errno != EAGAIN) {
      ended_ = true;
      throw std::runtime_error(name_ + ": " + reason());
    }
  }
  return !ended_;
}

/// Waits until the stream accepts output or a write would fail immediately. Returns false if `gives_up` has
/// returned true.
bool StandardStream::wait_for_room() const {
  // A signal that another thread receives does not interrupt poll(). Therefore poll() has a time limit, in
  // milliseconds, after which this function calls `gives_up` again.
  constexpr int kAskEvery = 100;
  pollfd stream{file_, POLLOUT, 0};
  while (poll(&stream, 1, 0) == 0) {
    if (gives_up_()) {
      return false;
    }
    poll(&stream, 1, kAskEvery);
  }
  return true;
}

}  // namespace ex9000::sim
