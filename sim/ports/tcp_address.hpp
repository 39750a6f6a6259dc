// What the command line says of a TCP port.
#pragma once

#include <cstdint>
#include <string>

namespace ex9000::sim {

/// Where to listen. An empty host is the loopback.
struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;  ///< 0: any that is free
};

/// HOST:PORT, :PORT, PORT or [IPV6]:PORT. Throws std::invalid_argument, one line.
TcpAddress parse_tcp_address(const std::string& text);

}  // namespace ex9000::sim
