// The Stellaris LM3S6965 evaluation board: clock, pins and polarity. README.md in this folder describes the
// wiring.
#pragma once

#include <array>
#include <cstdint>

#include "hal/stellaris/gpio.hpp"
#include "hal/stellaris/system_control.hpp"

namespace ex9000::board {

using hal::stellaris::Pin;
using hal::stellaris::PinGroup;
using hal::stellaris::Port;

inline constexpr auto kFamily = hal::stellaris::Family::Lm3s;

/// The crystal oscillates at 8 MHz. The system clock is 50 MHz, the highest frequency of the LM3S6965.
inline constexpr hal::stellaris::ClockTree kClock{0x0E, 4};

/// The line is UART0 on PA0 (receive) and PA1 (transmit).
inline constexpr unsigned kUart = 0;
inline constexpr PinGroup kUartPins{Port::A, 0, 2};
inline constexpr std::uint32_t kUartFunction = 1;
inline constexpr Pin kDriverEnable{Port::A, 6};

inline constexpr Pin kInitSwitch{Port::A, 7};
inline constexpr Pin kStatusLed{Port::F, 0};

/// The pins in the order of the channels. Outputs begin with the first eight pins, and inputs begin with
/// the second eight. A model with more than eight outputs has no inputs, and a model with more than eight
/// inputs has no outputs, so each such model can use both groups.
inline constexpr std::array<PinGroup, 2> kFirstEight{PinGroup{Port::D, 2, 6}, PinGroup{Port::G, 0, 2}};
inline constexpr std::array<PinGroup, 3> kSecondEight{PinGroup{Port::B, 0, 2}, PinGroup{Port::B, 4, 3},
                                                      PinGroup{Port::C, 4, 3}};
inline constexpr std::array<PinGroup, 5> kOutputs{kFirstEight[0], kFirstEight[1], kSecondEight[0],
                                                  kSecondEight[1], kSecondEight[2]};
inline constexpr std::array<PinGroup, 5> kInputs{kSecondEight[0], kSecondEight[1], kSecondEight[2],
                                                 kFirstEight[0], kFirstEight[1]};
inline constexpr bool kOutputsActiveHigh = true;
inline constexpr bool kInputsActiveHigh = true;

}  // namespace ex9000::board
