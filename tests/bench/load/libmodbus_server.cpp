// A typical Modbus RTU server that uses libmodbus: unit 1 with 13 coils.
//
//     libmodbus_server        on a pseudo-terminal; prints the path of the terminal. A signal ends the
//                             server
//     libmodbus_server tcp    RTU frames over TCP; prints the port and ends when its only client disconnects
//                             or sends an invalid request
#include <fcntl.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

/// Creates a pseudo-terminal and prints its path. Returns the master end, or -1 after an error.
int open_terminal() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) {
    return -1;
  }
  // The server keeps `other_end` open, so that no hang-up occurs while no Modbus master is connected. Raw
  // mode prevents an echo before the first Modbus master configures the terminal.
  const int other_end = open(ptsname(master), O_RDWR | O_NOCTTY);
  termios settings{};
  tcgetattr(other_end, &settings);
  cfmakeraw(&settings);
  tcsetattr(other_end, TCSANOW, &settings);
  std::printf("%s\n", ptsname(master));
  std::fflush(stdout);
  return master;
}

/// Listens on a free port, prints the port, and waits for a client. Returns the connection, or -1 after an
/// error.
int accept_client() {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (listener < 0 || bind(listener, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      listen(listener, 1) != 0 || getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return -1;
  }
  std::printf("%d\n", ntohs(address.sin_port));
  std::fflush(stdout);
  const int client = accept(listener, nullptr, nullptr);
  const int on = 1;
  setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return client;
}

}  // namespace

int main(int argc, char** argv) {
  const bool tcp = argc > 1 && std::strcmp(argv[1], "tcp") == 0;
  const int master = tcp ? accept_client() : open_terminal();
  if (master < 0) {
    std::perror("libmodbus_server");
    return 1;
  }
  // libmodbus does not open /dev/null, because the server calls modbus_set_socket and not modbus_connect.
  modbus_t* const server = modbus_new_rtu("/dev/null", 115200, 'N', 8, 1);
  modbus_mapping_t* const map = modbus_mapping_new(13, 0, 0, 0);
  if (server == nullptr || map == nullptr || modbus_set_slave(server, 1) != 0 ||
      modbus_set_socket(server, master) != 0) {
    std::fprintf(stderr, "libmodbus: %s\n", modbus_strerror(errno));
    return 1;
  }
  std::array<std::uint8_t, MODBUS_RTU_MAX_ADU_LENGTH> request{};
  for (;;) {
    const int size = modbus_receive(server, request.data());
    if (size > 0) {
      modbus_reply(server, request.data(), size, map);
    } else if (tcp && size < 0) {
      return 0;  // the client has disconnected, or its request is invalid
    }
  }
}
