// Host tests include this file instead of hal/registers/bus.hpp; its functions call
// registers::Microcontroller.
#pragma once

#include <cstdint>

namespace ex9000::hal::bus {

std::uint32_t read(std::uint32_t address);
void write(std::uint32_t address, std::uint32_t value);

}  // namespace ex9000::hal::bus
