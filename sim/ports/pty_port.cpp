#include "sim/ports/pty_port.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace ex9000::sim {

PtyPort::PtyPort(boost::asio::io_context& io, const std::string& link, std::uint32_t baud)
    : pty_(link, baud), visits_(io, pty_.visits_fd()), descriptor_(io, pty_.master_fd()) {}

/// The pseudo-terminal owns the file descriptors.
PtyPort::~PtyPort() {
  visits_.release();
  descriptor_.release();
}

void PtyPort::start(Received received) {
  received_ = std::move(received);
  watch_visits();
  read();
}

void PtyPort::resume() {
  paused_ = false;
  read();
}

void PtyPort::read() {
  if (reading_ || paused_) {
    return;
  }
  reading_ = true;
  descriptor_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                         [this](const boost::system::error_code& error) {
                           reading_ = false;
                           if (!error && take()) {
                             read();
                           }
                         });
}

void PtyPort::watch_visits() {
  visits_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                     [this](const boost::system::error_code& error) {
                       if (!error) {
                         pty_.take_visits();
                         read();
                         watch_visits();
                       }
                     });
}

/// Usually there is nothing to read, and a single system call detects that.
void PtyPort::read_waiting() {
  std::array<pollfd, 2> ready{{{pty_.visits_fd(), POLLIN, 0}, {pty_.master_fd(), POLLIN, 0}}};
  const bool any = poll(ready.data(), ready.size(), 0) > 0;
  if (any && ((ready[0].revents | ready[1].revents) & POLLIN) != 0) {
    take();
  }
}

/// Returns false if no master has the pseudo-terminal open.
bool PtyPort::take() {
  pty_.take_visits();  // detect a new master before replying to its bytes
  std::array<std::uint8_t, 4096> bytes{};
  while (!paused_) {
    const ssize_t size = ::read(pty_.master_fd(), bytes.data(), bytes.size());
    if (size <= 0) {
      return size < 0 && errno == EAGAIN;
    }
    paused_ = !received_(bytes.data(), static_cast<std::size_t>(size));
  }
  return true;
}

/// The pseudo-terminal buffers about 4 KiB before bytes are lost.
std::size_t PtyPort::send(const std::vector<std::uint8_t>& bytes) {
  if (!pty_.visited()) {
    return 0;
  }
  const ssize_t written = write(pty_.master_fd(), bytes.data(), bytes.size());
  return bytes.size() - (written < 0 ? 0 : static_cast<std::size_t>(written));
}

}  // namespace ex9000::sim
