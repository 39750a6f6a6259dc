// Single pins: INIT*, the status LED, and the driver enable of the RS-485 transceiver.
#pragma once

#include "hal/rp2040/gpio.hpp"

namespace ex9000::hal::rp2040 {

/// INIT*, active low, with the pin's weak pull-up.
template <const Pin& pin>
class InitPin {
 public:
  static void start() { Gpio::make_input(pin.mask(), true); }
  [[nodiscard]] static bool asserted() { return Gpio::read(pin.mask()) == 0; }
};

/// A status LED that is on while its pin is high.
template <const Pin& pin>
class LedPin {
 public:
  static void start() { Gpio::make_output(pin.mask(), 0); }
  static void light(bool on) { Gpio::write(pin.mask(), on ? pin.mask() : 0); }
};

/// An RS-485 driver that is on while its pin is high. The main loop turns the driver on and an interrupt
/// turns it off, so `drive` must be a single write to a register.
template <const Pin& pin>
class DriverEnablePin {
 public:
  static void start() { Gpio::make_output(pin.mask(), 0); }
  static void drive(bool on) {
    if (on) {
      Gpio::set(pin.mask());
    } else {
      Gpio::clear(pin.mask());
    }
  }
};

}  // namespace ex9000::hal::rp2040
