#include "tests/support/any_rate.hpp"

// Defines `termios`, as <termios.h> does; both cannot be included in the same file.
#include <asm/termbits.h>
#include <sys/ioctl.h>

namespace ex9000::system {

bool set_any_rate(int fd, std::uint32_t baud) {
  termios2 settings{};
  if (ioctl(fd, TCGETS2, &settings) != 0) {
    return false;
  }
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | CBAUD << IBSHIFT);
  settings.c_cflag |= BOTHER | BOTHER << IBSHIFT;
  settings.c_ispeed = baud;
  settings.c_ospeed = baud;
  return ioctl(fd, TCSETS2, &settings) == 0;
}

}  // namespace ex9000::system
