// Replaces hal/registers/bus.hpp. A test supplies the registers. An interrupt can occur before and after each
// access by the main loop.
#pragma once

#include <cstdint>

#include "tests/support/interleaving/points.hpp"

namespace ex9000::hal::bus {

/// The registers at all addresses. A test implements this interface.
class Peripherals {
 public:
  virtual std::uint32_t read(std::uint32_t address) = 0;
  virtual void write(std::uint32_t address, std::uint32_t value) = 0;

 protected:
  ~Peripherals() = default;
};

inline Peripherals* peripherals = nullptr;

inline std::uint32_t read(std::uint32_t address) {
  interleaving::Points::pass();
  const std::uint32_t value = peripherals->read(address);
  interleaving::Points::pass();
  return value;
}
inline void write(std::uint32_t address, std::uint32_t value) {
  interleaving::Points::pass();
  peripherals->write(address, value);
  interleaving::Points::pass();
}

}  // namespace ex9000::hal::bus
