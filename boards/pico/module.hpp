// The Raspberry Pi Pico and the Pico W: the pins, and the polarity of the inputs and outputs. For the
// firmware, the two boards differ only in the pin of the status LED, which board.hpp of each board defines.
// README.md in this folder describes the wiring.
#pragma once

#include <array>

#include "boards/pico/every_pico.hpp"

namespace ex9000::board {

inline constexpr Pin kDriverEnable{2};

/// The pins in the order of the channels. The first eight outputs are on GPIO6 to GPIO13, and the first eight
/// inputs are on GPIO14 to GPIO21. A model with more than eight outputs has no inputs, and a model with more
/// than eight inputs has no outputs, so each such model can use both groups.
inline constexpr std::array<PinGroup, 2> kOutputs{PinGroup{6, 8}, PinGroup{14, 8}};
inline constexpr std::array<PinGroup, 2> kInputs{PinGroup{14, 8}, PinGroup{6, 8}};
inline constexpr bool kOutputsActiveHigh = true;
/// While an input is logic 1, its optocoupler pulls the pin low.
inline constexpr bool kInputsActiveHigh = false;

}  // namespace ex9000::board
