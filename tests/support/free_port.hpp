// TCP ports for programs that cannot select a port themselves.
#pragma once

#include <cstdint>

namespace ex9000::system {

/// Returns a TCP port of the loopback on which no program listens. Each call in a process returns another
/// port. The ports are below 32768, and Linux itself assigns no port in that range, so no other program
/// receives one in the meantime. Processes begin at different ports. Throws std::runtime_error if no port is
/// free.
std::uint16_t free_port();

}  // namespace ex9000::system
