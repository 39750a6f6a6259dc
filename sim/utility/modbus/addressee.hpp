// Who gets a Modbus request.
#pragma once

#include <string>

#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

/// An address, or function 46 (hex) with a serial number (extensions.md, scan).
struct Addressee {
  std::string name;  ///< for people
  Data request;      ///< precedes the PDU of a request
  Data reply;        ///< and that of a reply

  [[nodiscard]] bool by_address() const { return request.size() == 1; }
};

Addressee at_address(std::uint8_t address);
Addressee with_serial_number(std::uint32_t number);

/// 1 to 247, or 8 hex digits. Throws std::invalid_argument.
Addressee parse_addressee(const std::string& text);

}  // namespace ex9000::utility
