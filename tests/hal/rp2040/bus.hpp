// In host tests, the drivers of the RP2040 access registers of an object that the test provides.
#pragma once

#include <cstdint>

namespace ex9000::rp2040_model {

class Bus {
 public:
  Bus() { current_ = this; }
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() { current_ = nullptr; }
  virtual std::uint32_t read(std::uint32_t address) = 0;
  virtual void write(std::uint32_t address, std::uint32_t value) = 0;

  static Bus& current() { return *current_; }

 private:
  static inline Bus* current_ = nullptr;
};

}  // namespace ex9000::rp2040_model

namespace ex9000::hal::bus {

inline std::uint32_t read(std::uint32_t address) { return rp2040_model::Bus::current().read(address); }
inline void write(std::uint32_t address, std::uint32_t value) {
  rp2040_model::Bus::current().write(address, value);
}

}  // namespace ex9000::hal::bus
