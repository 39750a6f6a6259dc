// TCP ports for programs that cannot select a port themselves.
#pragma once

#include <cstdint>

namespace ex9000::system {

/// Returns a TCP port at which no program listens on the loopback interface. Each call in a process returns a
/// different port, and processes with neighbouring process ids begin at different ports. All returned ports
/// are below 32768. By default, Linux automatically assigns only ports from 32768. Therefore Linux does not
/// assign the returned port to another program before the test uses the port. Throws std::runtime_error if
/// no port is free.
std::uint16_t free_port();

}  // namespace ex9000::system
