#include "sim/files_and_ports/ports/terminal_rate.hpp"

// This header and <termios.h> cannot be included in the same file, because both define `termios`. Only this
// one has termios2. tcgetattr() does not return a rate that was set with BOTHER.
#include <asm/termbits.h>
#include <sys/ioctl.h>

namespace ex9000::sim {

std::optional<std::uint32_t> terminal_rate(int fd) {
  termios2 settings{};
  if (ioctl(fd, TCGETS2, &settings) != 0 || settings.c_ospeed == 0) {
    return std::nullopt;
  }
  return settings.c_ospeed;
}

}  // namespace ex9000::sim
