#include "tests/support/pty_bridge.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <utility>

#include "sim/app/play/modbus_frame.hpp"

namespace ex9000::system {

namespace {

/// Returns whether the bytes are a whole frame with a correct CRC. The shortest frame consists of address,
/// function and CRC.
bool is_whole(const PtyBridge::Bytes& request) {
  constexpr std::size_t kCrc = 2;
  constexpr std::size_t kShortest = 4;
  return request.size() >= kShortest &&
         with_crc(PtyBridge::Bytes(request.begin(), request.end() - kCrc)) == request;
}

}  // namespace

PtyBridge::PtyBridge(std::function<Bytes(const Bytes&)> exchange)
    : exchange_(std::move(exchange)),
      fd_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)),
      over_(eventfd(0, EFD_CLOEXEC)) {
  std::array<char, 64> name{};
  if (over_ < 0 || fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 ||
      ptsname_r(fd_, name.data(), name.size()) != 0) {
    throw std::runtime_error("no pseudo-terminal");
  }
  tty_ = name.data();
  held_open_ = open(tty_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  tcgetattr(held_open_, &settings);
  cfmakeraw(&settings);
  tcsetattr(held_open_, TCSANOW, &settings);
  carrier_ = std::thread([this] {
    try {
      carry();
    } catch (const std::exception&) {
      failure_ = std::current_exception();
    }
  });
}

PtyBridge::~PtyBridge() {
  try {
    end();
  } catch (const std::exception&) {  // a destructor must not throw; a test that needs the error calls `end`
  }
  close(held_open_);
  close(fd_);
  close(over_);
}

void PtyBridge::end() {
  if (carrier_.joinable()) {
    eventfd_write(over_, 1);
    carrier_.join();
  }
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
}

void PtyBridge::carry() {
  constexpr int kNoTimeout = -1;
  for (;;) {
    std::array<pollfd, 2> ready{{{fd_, POLLIN, 0}, {over_, POLLIN, 0}}};
    if (poll(ready.data(), ready.size(), kNoTimeout) < 0 || ready[1].revents != 0) {
      return;
    }
    std::array<std::uint8_t, 512> buffer{};
    const ssize_t size = read(fd_, buffer.data(), buffer.size());
    for (ssize_t i = 0; i < size; ++i) {
      take(buffer.at(static_cast<std::size_t>(i)));
    }
  }
}

void PtyBridge::take(std::uint8_t byte) {
  request_.push_back(byte);
  if (is_whole(request_)) {
    const Bytes reply = exchange_(std::exchange(request_, {}));
    if (write(fd_, reply.data(), reply.size()) != static_cast<ssize_t>(reply.size())) {
      throw std::runtime_error("the pseudo-terminal does not accept the reply");
    }
  }
}

}  // namespace ex9000::system
