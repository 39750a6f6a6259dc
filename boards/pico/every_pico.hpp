// What all boards with a Raspberry Pi Pico have in common: the clock, the memory of the settings, the line
// and INIT*.
#pragma once

#include <cstdint>

#include "boards/rp2040/memory.hpp"
#include "hal/rp2040/clocks.hpp"
#include "hal/rp2040/gpio.hpp"

namespace ex9000::board {

using hal::rp2040::Pin;
using hal::rp2040::PinGroup;

/// The crystal oscillates at 12 MHz. The oscillator of the PLL runs at 1500 MHz. The processor and the
/// peripherals run at 125 MHz.
inline constexpr hal::rp2040::ClockTree kClock{12'000'000, 125, 6, 2};

#ifdef EX9000_SETTINGS_IN_EEPROM
inline constexpr Memory kMemory = Memory::Eeprom;
#else
inline constexpr Memory kMemory = Memory::Flash;
#endif
/// The offset in the flash, in bytes, of the first byte for settings. Only images that store the settings in
/// the flash use this offset. image.ld reserves the last 64 KiB of the flash for settings.
inline constexpr std::uint32_t kSettingsInFlash = (2048U - 64U) * 1024U;

/// The line is UART0 on GPIO0 (transmit) and GPIO1 (receive).
inline constexpr PinGroup kUartPins{0, 2};
inline constexpr Pin kInitSwitch{3};
/// The EEPROM is on I2C0: GPIO4 (SDA) and GPIO5 (SCL).
inline constexpr PinGroup kI2cPins{4, 2};

}  // namespace ex9000::board
