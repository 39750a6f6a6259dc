// The only functions through which drivers access registers.
#pragma once

#include <cstdint>

namespace ex9000::hal::bus {

/// `address`: a multiple of 4. Each call is exactly one access, which the compiler does not remove, repeat or
/// move across another. For interrupts and the main loop; does not block.
// NOLINTBEGIN(performance-no-int-to-ptr): the address of a register is a number
inline std::uint32_t read(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
inline void write(std::uint32_t address, std::uint32_t value) {
  *reinterpret_cast<volatile std::uint32_t*>(address) = value;
}
// NOLINTEND(performance-no-int-to-ptr)

}  // namespace ex9000::hal::bus
