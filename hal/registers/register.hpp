// Registers and their bits. A register takes only bits of its own type; the compiler rejects others.
#pragma once

#include <cstdint>

#include "hal/registers/bus.hpp"

namespace ex9000::hal {

/// `Name` identifies the register. Registers with the same bits may share it.
template <class Name>
class Bits {
 public:
  constexpr Bits() = default;
  constexpr explicit Bits(std::uint32_t value) : value_(value) {}

  [[nodiscard]] constexpr std::uint32_t value() const { return value_; }
  /// Any of `bits`.
  [[nodiscard]] constexpr bool has(Bits bits) const { return (value_ & bits.value_) != 0; }
  [[nodiscard]] constexpr Bits without(Bits bits) const { return Bits(value_ & ~bits.value_); }
  friend constexpr Bits operator|(Bits a, Bits b) { return Bits(a.value_ | b.value_); }

 private:
  std::uint32_t value_ = 0;
};

/// 32 bits. `set` and `clear` read, then write: only if no interrupt can write the register in between.
template <class Name>
class Register {
 public:
  constexpr explicit Register(std::uint32_t address) : address_(address) {}

  [[nodiscard]] Bits<Name> read() const { return Bits<Name>(bus::read(address_)); }
  void write(Bits<Name> bits) const { bus::write(address_, bits.value()); }
  void set(Bits<Name> bits) const { write(read() | bits); }
  void clear(Bits<Name> bits) const { write(read().without(bits)); }

 private:
  std::uint32_t address_;
};

}  // namespace ex9000::hal
