// The Raspberry Pi Pico.
#pragma once

#include <string_view>

#include "boards/pico/module.hpp"

namespace ex9000::board {

/// In signatures of images: firmware/update/signature.hpp.
inline constexpr std::string_view kBoardCode = kMemory == Memory::Flash ? "pico" : "pice";

inline constexpr Pin kStatusLed{25};  ///< the LED on the board

}  // namespace ex9000::board
