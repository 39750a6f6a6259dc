// The syntax of TCP addresses on the command line and in bus files.
#pragma once

#include <cstdint>
#include <string>

namespace ex9000::sim {

struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;  ///< 0 in an address to listen on: any free port
};

/// HOST:PORT, :PORT, PORT or [IPV6]:PORT. Without HOST, 127.0.0.1.
TcpAddress parse_tcp_address(const std::string& text);
/// HOST must be numeric, or `localhost` for 127.0.0.1: other names require the system's name services, which
/// a static program may not be able to use.
TcpAddress parse_listening_address(const std::string& text);

}  // namespace ex9000::sim
