// Registers in which one write sets or clears single bits. Source: RP2040 data sheet, 2.1.2.
#pragma once

#include <cstdint>

#include "hal/registers/bus.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::rp2040 {

/// On the APB or AHB-Lite bus. A write to further addresses sets or clears only the given bits, so no
/// interrupt can come between a read and a write. SIO and the SSI do not have this.
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
