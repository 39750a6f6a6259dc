// The only place where a driver touches the processor's bus.
#pragma once

#include <cstdint>

namespace ex9000::hal::bus {

/// Reads or writes the 32-bit register at `address`, a multiple of 4; each call is one access, never left
/// out, doubled or moved by the compiler. Interrupts and main loop; does not block.
// NOLINTBEGIN(performance-no-int-to-ptr): that a register has a number for an address is what the bus is
inline std::uint32_t read(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
inline void write(std::uint32_t address, std::uint32_t value) {
  *reinterpret_cast<volatile std::uint32_t*>(address) = value;
}
// NOLINTEND(performance-no-int-to-ptr)

}  // namespace ex9000::hal::bus
