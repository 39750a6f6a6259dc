// The module's signals at the pins of the emulated board, seen from outside the microcontroller.
#pragma once

#include <cstdint>
#include <string>

#include "boards/lm3s6965evb/board.hpp"
#include "tests/qemu/qtest_client.hpp"

namespace ex9000::rig {

using hal::stellaris::Pin;

/// The pin of a channel; throws std::out_of_range where the board has none.
Pin input_pin(unsigned channel);
Pin output_pin(unsigned channel);

/// Bus address of the registers of the pin's port.
std::uint32_t port_address(Pin pin);
/// Of the data register, where it shows this pin alone.
std::uint32_t data_address(Pin pin);

bool level_of(QtestClient& bus, Pin pin);
/// Gives an input its level, which it keeps until the next reset.
void give_level(QtestClient& bus, Pin pin, bool level);

}  // namespace ex9000::rig
