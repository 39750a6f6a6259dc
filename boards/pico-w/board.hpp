// The Raspberry Pi Pico W. Its LED is connected to the radio chip, so the module requires an external status
// LED.
#pragma once

#include "boards/pico/module.hpp"

namespace ex9000::board {

inline constexpr Pin kStatusLed{22};

}  // namespace ex9000::board
