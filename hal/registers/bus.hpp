// The only functions through which drivers access registers.
#pragma once

#include <cstdint>

namespace ex9000::hal::bus {

/// Reads or writes the 32-bit register at `address`, which must be a multiple of 4. Each call is exactly one
/// access. The compiler does not remove or repeat this access, and does not move it across another such
/// access. For interrupts and the main loop; does not block.
// NOLINTBEGIN(performance-no-int-to-ptr): the address of a register is a number
inline std::uint32_t read(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
inline void write(std::uint32_t address, std::uint32_t value) {
  *reinterpret_cast<volatile std::uint32_t*>(address) = value;
}
// NOLINTEND(performance-no-int-to-ptr)

}  // namespace ex9000::hal::bus
