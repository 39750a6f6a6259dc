// The Raspberry Pi Pico W. The LED on the board is connected to the radio chip, so the status LED is an
// external LED at GP22.
#pragma once

#include <string_view>

#include "boards/pico/module.hpp"

namespace ex9000::board {

/// In signatures of images: firmware/update/signature.hpp.
inline constexpr std::string_view kBoardCode = kMemory == Memory::Flash ? "picw" : "piwe";

inline constexpr Pin kStatusLed{22};

}  // namespace ex9000::board
