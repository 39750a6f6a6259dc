// The PORT of a command line.
#pragma once

#include <memory>
#include <string>

#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

struct Port {
  enum class Kind : std::uint8_t {
    Serial,     ///< a device, also a pseudo-terminal
    Tcp,        ///< the bytes of the line, over TCP
    ModbusTcp,  ///< a gateway
  };
  Kind kind = Kind::Serial;
  std::string name;  ///< as the user has written it
  std::string host;  ///< of Tcp and ModbusTcp
  std::string number;
};

/// A device; tcp:HOST:PORT; modbus-tcp:HOST[:PORT]. Throws std::invalid_argument.
Port parse_port(const std::string& text);

/// Throws std::runtime_error if it is not there or in use, std::invalid_argument if it is none, or cannot
/// have the mode.
std::unique_ptr<Connection> open(const Port& port, hal::SerialMode mode);

}  // namespace ex9000::utility
