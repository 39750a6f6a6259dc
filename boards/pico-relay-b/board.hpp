// A Raspberry Pi Pico with a Waveshare Pico-Relay-B and a Waveshare Pico-2CH-RS485. README.md in this folder
// names the sources of the pins, and describes the wiring.
#pragma once

#include <array>
#include <string_view>

#include "boards/pico/every_pico.hpp"
#include "hal/pins/single_pins.hpp"

namespace ex9000::board {

/// In signatures of images: firmware/update/signature.hpp.
inline constexpr std::string_view kBoardCode = "picb";

static_assert(kMemory == Memory::Flash,
              "EX9000_MEMORY: the pins of the EEPROM lead to channel 1 of the "
              "Pico-2CH-RS485; use flash");

inline constexpr hal::NoPin kDriverEnable{};  ///< the transceiver switches its direction automatically

inline constexpr Pin kStatusLed{25};  ///< the LED on the Pico

/// Relay 1 is on GPIO21, relay 8 on GPIO14.
inline constexpr std::array<PinGroup, 8> kOutputs{PinGroup{21, 1}, PinGroup{20, 1}, PinGroup{19, 1},
                                                  PinGroup{18, 1}, PinGroup{17, 1}, PinGroup{16, 1},
                                                  PinGroup{15, 1}, PinGroup{14, 1}};
inline constexpr std::array<PinGroup, 0> kInputs{};
inline constexpr bool kOutputsActiveHigh = true;
inline constexpr bool kInputsActiveHigh = false;

}  // namespace ex9000::board
