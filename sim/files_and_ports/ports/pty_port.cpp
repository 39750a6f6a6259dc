#include "sim/files_and_ports/ports/pty_port.hpp"

#include <unistd.h>

#include <cerrno>
#include <utility>

#include "sim/text/fail.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

PtyPort::PtyPort(boost::asio::io_context& io, const std::string& link, std::uint32_t baud,
                 const std::optional<PtyAccess>& access)
    : pty_(link, baud, access),
      visits_(boost::asio::use_service<Visits>(io)),
      watch_(watch()),
      descriptor_(io, pty_.master_fd()) {}

int PtyPort::watch() {
  const auto visited = [this] {
    if (pty_.take_visit() && arrivals_ != nullptr) {
      let_line_go(*arrivals_);
    }
    read();
  };
  return with_place(pty_.link() + ": ", [&] { return visits_.watch(pty_.device(), visited); });
}

/// Releases the file descriptor without closing it, because the pseudo-terminal owns it.
PtyPort::~PtyPort() {
  visits_.ignore(watch_);
  descriptor_.release();
}

PortSummary PtyPort::summary() const {
  return {"pty", pty_.link(), "pseudo-terminal " + shell_word(pty_.link()) + " (" + pty_.device() + ")"};
}

void PtyPort::start(Arrivals& arrivals) {
  arrivals_ = &arrivals;
  read();
}

void PtyPort::resume() {
  paused_ = false;
  read();
}

void PtyPort::read() {
  if (arrivals_ == nullptr || reading_ || paused_) {
    return;
  }
  reading_ = true;
  descriptor_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                         [this](const boost::system::error_code& error) {
                           reading_ = false;
                           if (!error && !paused_ && take() >= 0) {
                             read();
                           }
                         });
}

void PtyPort::read_waiting() {
  while (!paused_ && take() > 0) {
  }
}

/// Reads bytes and delivers them. Returns the number of bytes. If there are none, returns 0 if a
/// master has the pseudo-terminal open, otherwise a negative number.
ssize_t PtyPort::take() {
  visits_.take();  // a new master must be detected before the program replies to its bytes
  const ssize_t size = ::read(pty_.master_fd(), bytes_.data(), bytes_.size());
  if (size > 0) {
    paused_ = !arrivals_->bytes(*this, {bytes_.data(), static_cast<std::size_t>(size)}, {}, nullptr);
    return size;
  }
  return size < 0 && errno == EAGAIN ? 0 : -1;
}

}  // namespace ex9000::sim
