#include "sim/app/main/standard_stream.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <stdexcept>
#include <utility>

#include "sim/text/system_error.hpp"

namespace ex9000::sim {

StandardStream::StandardStream(int file, std::string name, GivesUp gives_up)
    : file_(file), name_(std::move(name)), gives_up_(std::move(gives_up)) {}

/// In pieces of PIPE_BUF bytes, which a pipe that has room accepts without blocking.
bool StandardStream::write(const std::string& text) {
  for (std::size_t done = 0; done < text.size() && !ended_;) {
    if (!wait_for_room(file_, gives_up_)) {
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

}  // namespace ex9000::sim
