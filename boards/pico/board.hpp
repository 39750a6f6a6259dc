// The Raspberry Pi Pico.
#pragma once

#include "boards/pico/module.hpp"

namespace ex9000::board {

inline constexpr Pin kStatusLed{25};  ///< the LED on the board

}  // namespace ex9000::board
