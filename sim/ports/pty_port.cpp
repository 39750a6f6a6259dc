#include "sim/ports/pty_port.hpp"

#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <utility>

namespace ex9000::sim {

PtyPort::PtyPort(boost::asio::io_context& io, const std::string& link, std::uint32_t baud)
    : pty_(link, baud), visits_(io, pty_.visits_fd()), descriptor_(io, pty_.master_fd()) {}

/// They are the pseudo-terminal's.
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
  descriptor_.async_read_some(boost::asio::buffer(buffer_),
                              [this](const boost::system::error_code& error, std::size_t size) {
                                reading_ = false;
                                if (error) {
                                  return;  // nobody is there any more
                                }
                                pty_.take_visits();  // who writes must be there when it is answered
                                paused_ = !received_(buffer_.data(), size);
                                read();
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

/// The pseudo-terminal holds some 4 KiB before anything is lost.
void PtyPort::send(const std::vector<std::uint8_t>& bytes) {
  if (pty_.visited()) {
    [[maybe_unused]] const ssize_t written = write(pty_.master_fd(), bytes.data(), bytes.size());
  }
}

}  // namespace ex9000::sim
