#pragma once

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace ex9000::registers {

/// Reports one of these: an action that the data sheet forbids or leaves undefined, that causes a bus fault,
/// or that the model does not implement; a sleep that no event can end; an exception without a handler.
class Fault : public std::runtime_error {
 public:
  Fault(std::uint32_t address, const std::string& what) : std::runtime_error(hex(address) + ": " + what) {}

 private:
  static std::string hex(std::uint32_t address) {
    char text[11];
    (void)std::snprintf(text, sizeof text, "0x%08X", address);
    return text;
  }
};

}  // namespace ex9000::registers
