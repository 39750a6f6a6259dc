// TCP ports for programs that cannot select a port themselves.
#pragma once

#include <cstdint>

namespace ex9000::system {

/// Returns a TCP port of the loopback interface on which no program listens. Each call in a process returns a
/// different port, and processes with neighbouring process ids begin at different ports. All returned ports
/// are below 32768. By default, Linux assigns no port below 32768 by itself, so it does not assign the
/// returned port to another program before the test uses it. Throws std::runtime_error if no port is free.
std::uint16_t free_port();

}  // namespace ex9000::system
