// Registers in which one write can set or clear single bits. Source: RP2040 data sheet, 2.1.2 (atomic
// register access).
#pragma once

#include <cstdint>

#include "hal/registers/bus.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::rp2040 {

/// A register of a peripheral on the APB or AHB-Lite bus. Such a register has several addresses. At one of
/// them, a write sets only the given bits. At another one, a write clears only the given bits. `set` and
/// `clear` therefore do not read the register first, so no interrupt can change it between a read and a
/// write. The registers of SIO and of the SSI do not have these addresses.
template <class Name>
class SharedRegister {
 public:
  constexpr explicit SharedRegister(std::uint32_t address) : address_(address) {}

  [[nodiscard]] Bits<Name> read() const { return Bits<Name>(bus::read(address_)); }
  void write(Bits<Name> bits) const { bus::write(address_, bits.value()); }
  void set(Bits<Name> bits) const { bus::write(address_ + kSetAlias, bits.value()); }
  void clear(Bits<Name> bits) const { bus::write(address_ + kClearAlias, bits.value()); }

 private:
  static constexpr std::uint32_t kSetAlias = 0x2000;
  static constexpr std::uint32_t kClearAlias = 0x3000;

  std::uint32_t address_;
};

}  // namespace ex9000::hal::rp2040
