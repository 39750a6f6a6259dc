// The Raspberry Pi Pico W. Its LED is connected to the radio chip, so the status LED is a part of the module.
#pragma once

#include "boards/pico/module.hpp"

namespace ex9000::board {

inline constexpr Pin kStatusLed{22};

}  // namespace ex9000::board
