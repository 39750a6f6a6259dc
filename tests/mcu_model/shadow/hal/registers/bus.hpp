// Some host tests, and the images that they load, include this file instead of hal/registers/bus.hpp.
// tests/mcu_model/microcontroller.cpp defines these functions; start_up_test has its own definitions.
#pragma once

#include <cstdint>

namespace ex9000::hal::bus {

std::uint32_t read(std::uint32_t address);
void write(std::uint32_t address, std::uint32_t value);

}  // namespace ex9000::hal::bus
