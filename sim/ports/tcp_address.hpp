// The syntax of TCP addresses on the command line.
#pragma once

#include <cstdint>
#include <string>

namespace ex9000::sim {

/// The address to listen on. An empty host means the loopback.
struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;  ///< 0: any free port
};

/// Parses HOST:PORT, :PORT, PORT or [IPV6]:PORT. Throws std::invalid_argument with a one-line message.
TcpAddress parse_tcp_address(const std::string& text);

}  // namespace ex9000::sim
