// The syntax of TCP addresses on the command line and in bus files.
#pragma once

#include <cstdint>
#include <string>

namespace ex9000::sim {

/// An address to listen on or to connect to.
struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;  ///< 0 in an address to listen on: any free port
};

/// Parses HOST:PORT, :PORT, PORT or [IPV6]:PORT. Without HOST, the result has the loopback address 127.0.0.1.
/// Throws std::invalid_argument with a one-line message if the syntax is wrong.
TcpAddress parse_tcp_address(const std::string& text);
/// Parses an address to listen on, in the same syntax. HOST must be a numeric address, or `localhost` for
/// 127.0.0.1. Other names would require the name services of the system, which a statically linked program
/// may not be able to use. Throws std::invalid_argument with a one-line message if the syntax or HOST is
/// wrong.
TcpAddress parse_listening_address(const std::string& text);

}  // namespace ex9000::sim
