// The module's signals at the pins of the emulated board, as seen from outside the microcontroller.
#pragma once

#include <cstdint>
#include <string>

#include "boards/lm3s6965evb/board.hpp"
#include "tests/qemu/qtest_client.hpp"

namespace ex9000::rig {

using hal::stellaris::Pin;

/// Returns the pin of a channel. Throws std::out_of_range if the board has no such channel.
Pin input_pin(unsigned channel);
Pin output_pin(unsigned channel);

/// Returns the bus address of the registers of the pin's port.
std::uint32_t port_address(Pin pin);
/// Returns the bus address at which the data register shows only this pin.
std::uint32_t data_address(Pin pin);

bool level_of(QtestClient& bus, Pin pin);
/// Sets the level of an input. The level stays until the next reset.
void set_pin_level(QtestClient& bus, Pin pin, bool level);

}  // namespace ex9000::rig
