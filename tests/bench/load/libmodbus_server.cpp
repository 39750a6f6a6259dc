// A typical Modbus RTU server that uses libmodbus: unit 1 with 13 coils on a pseudo-terminal. The server
// holds the master end and prints the path of the other end. It serves until it is terminated.
#include <fcntl.h>
#include <modbus/modbus.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

int main() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) {
    std::perror("pseudo-terminal");
    return 1;
  }
  // Keeping this end open prevents a hang-up when one master disconnects and the next one connects. Raw mode
  // prevents an echo before the first master configures the terminal.
  const int other_end = open(ptsname(master), O_RDWR | O_NOCTTY);
  termios settings{};
  tcgetattr(other_end, &settings);
  cfmakeraw(&settings);
  tcsetattr(other_end, TCSANOW, &settings);

  modbus_t* const server = modbus_new_rtu(ptsname(master), 115200, 'N', 8, 1);
  modbus_mapping_t* const map = modbus_mapping_new(13, 0, 0, 0);
  if (server == nullptr || map == nullptr || modbus_set_slave(server, 1) != 0 ||
      modbus_set_socket(server, master) != 0) {
    std::fprintf(stderr, "libmodbus: %s\n", modbus_strerror(errno));
    return 1;
  }
  std::printf("%s\n", ptsname(master));
  std::fflush(stdout);
  std::array<std::uint8_t, MODBUS_RTU_MAX_ADU_LENGTH> request{};
  for (;;) {
    const int size = modbus_receive(server, request.data());
    if (size > 0) {
      modbus_reply(server, request.data(), size, map);
    }
  }
}
