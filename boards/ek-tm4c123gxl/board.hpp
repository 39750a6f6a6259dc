// The EK-TM4C123GXL LaunchPad: clock, pins and polarity. README.md in this folder describes the wiring.
#pragma once

#include <array>
#include <cstdint>

#include "hal/stellaris/gpio.hpp"
#include "hal/stellaris/system_control.hpp"

namespace ex9000::board {

using hal::stellaris::Pin;
using hal::stellaris::PinGroup;
using hal::stellaris::Port;

inline constexpr auto kFamily = hal::stellaris::Family::Tm4c;

/// The crystal oscillates at 16 MHz, and the system clock is 50 MHz. The LM3S6965 board has the same system
/// clock, so start_up_driver_test.cpp expects the same UART divisors on both boards.
inline constexpr hal::stellaris::ClockTree kClock{0x15, 4};

#ifdef EX9000_BUS_ON_USB
/// The line is UART0 on PA0 (receive) and PA1 (transmit). The debugger on the LaunchPad connects UART0 to a
/// USB serial port.
inline constexpr unsigned kUart = 0;
inline constexpr PinGroup kUartPins{Port::A, 0, 2};
inline constexpr std::uint32_t kUartFunction = 1;
#else
/// The line is UART1 on PC4 (receive) and PC5 (transmit).
inline constexpr unsigned kUart = 1;
inline constexpr PinGroup kUartPins{Port::C, 4, 2};
inline constexpr std::uint32_t kUartFunction = 2;
#endif
inline constexpr Pin kDriverEnable{Port::C, 6};

inline constexpr Pin kInitSwitch{Port::F, 4};  ///< SW1
inline constexpr Pin kStatusLed{Port::F, 3};   ///< green

/// The pins in the order of the channels. Outputs begin with the first eight pins, and inputs begin with
/// the second eight. A model with more than eight outputs has no inputs, and a model with more than eight
/// inputs has no outputs, so each such model can use both groups.
inline constexpr std::array<PinGroup, 2> kFirstEight{PinGroup{Port::A, 2, 6}, PinGroup{Port::D, 2, 2}};
inline constexpr std::array<PinGroup, 2> kSecondEight{PinGroup{Port::E, 0, 6}, PinGroup{Port::B, 4, 2}};
inline constexpr std::array<PinGroup, 4> kOutputs{kFirstEight[0], kFirstEight[1], kSecondEight[0],
                                                  kSecondEight[1]};
inline constexpr std::array<PinGroup, 4> kInputs{kSecondEight[0], kSecondEight[1], kFirstEight[0],
                                                 kFirstEight[1]};
inline constexpr bool kOutputsActiveHigh = true;
inline constexpr bool kInputsActiveHigh = true;

}  // namespace ex9000::board
