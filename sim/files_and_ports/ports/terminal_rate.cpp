#include "sim/files_and_ports/ports/terminal_rate.hpp"

// Only this header has termios2, which tells rates set with BOTHER. Like <termios.h>, it defines `termios`.
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
