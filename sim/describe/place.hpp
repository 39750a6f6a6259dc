// Where a tool finds the module: the simulator's TCP port and the address on its line.
#pragma once

#include <cstdint>

#include "sim/ports/tcp_address.hpp"

namespace ex9000::sim {

struct Place {
  TcpAddress tcp{"127.0.0.1", 5020};
  std::uint8_t address = 0x01;  ///< 1 to 247
};

}  // namespace ex9000::sim
