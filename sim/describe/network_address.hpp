// The addresses that a tool requires to reach a module: the simulator's host and TCP port, and the module's
// Modbus address.
#pragma once

#include <cstdint>

#include "sim/ports/tcp_address.hpp"

namespace ex9000::sim {

struct NetworkAddress {
  TcpAddress tcp{"127.0.0.1", 5020};
  std::uint8_t address = 0x01;  ///< 1 to 247
};

}  // namespace ex9000::sim
