#include "tests/qemu/pty_bridge.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace ex9000::rig {

PtyBridge::PtyBridge(EmulatedModule& module)
    : module_(module), fd_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
  std::array<char, 64> name{};
  if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 || ptsname_r(fd_, name.data(), name.size()) != 0) {
    throw std::runtime_error("no pseudo-terminal");
  }
  tty_ = name.data();
  held_open_ = open(tty_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  tcgetattr(held_open_, &settings);
  cfmakeraw(&settings);
  tcsetattr(held_open_, TCSANOW, &settings);
  carrier_ = std::thread([this] { carry(); });
}

PtyBridge::~PtyBridge() {
  over_ = true;
  carrier_.join();
  close(held_open_);
  close(fd_);
}

void PtyBridge::carry() {
  constexpr int kTurnMilliseconds = 20;
  while (!over_) {
    std::array<pollfd, 2> ready{{{fd_, POLLIN, 0}, {module_.emulator().uart().fd(), POLLIN, 0}}};
    if (poll(ready.data(), ready.size(), kTurnMilliseconds) <= 0) {
      continue;
    }
    if (ready[0].revents != 0) {
      std::array<std::uint8_t, 512> buffer{};
      const ssize_t size = read(fd_, buffer.data(), buffer.size());
      if (size > 0) {
        module_.send({buffer.begin(), buffer.begin() + size});
      }
    }
    if (ready[1].revents != 0) {
      const auto bytes = module_.hear(std::chrono::nanoseconds(0));
      if (write(fd_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
        return;
      }
    }
  }
}

}  // namespace ex9000::rig
