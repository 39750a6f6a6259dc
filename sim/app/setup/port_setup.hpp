// A port in the notation of the user: KIND:WHERE[,OPTION[=VALUE]]...
//
//   pty:plc.tty,access=660:dialout
//   tcp:5020
//   modbus-tcp:localhost:5021,timeout=1s,wait
//   serial:/dev/ttyUSB0,echo
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sim/files_and_ports/ports/pty_access.hpp"
#include "sim/files_and_ports/ports/tcp_address.hpp"
#include "sim/front_ends/modbus_tcp/gateway.hpp"

namespace ex9000::sim {

struct PortSetup {
  enum class Kind : std::uint8_t { Pty, Tcp, ModbusTcp, Serial };

  Kind kind = Kind::Pty;
  std::string text;                       ///< KIND:WHERE, for messages
  std::string path;                       ///< Pty: the link; Serial: the device
  TcpAddress address;                     ///< Tcp, ModbusTcp: to listen on
  std::optional<PtyAccess> access;        ///< Pty; nullopt: as the system creates it
  VirtualTime timeout = kGatewayTimeout;  ///< ModbusTcp
  bool echo = false;                      ///< Serial: the adapter receives what it sends
  bool wait = false;                      ///< line time begins when a master has connected
  std::string place;                      ///< prefix of messages
};

PortSetup parse_port(const std::string& text);

std::string port_help();

}  // namespace ex9000::sim
