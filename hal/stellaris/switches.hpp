// INIT* and the status LED, one pin each.
#pragma once

#include "hal/stellaris/gpio.hpp"

namespace ex9000::hal::stellaris {

/// INIT*, active low, with the pin's weak pull-up.
template <const Pin& pin>
class InitPin {
 public:
  static void start() { Gpio(pin.port).make_input(pin.mask(), true); }
  [[nodiscard]] static bool asserted() { return Gpio(pin.port).read(pin.mask()) == 0; }
};

/// A status LED that is on while its pin is high.
template <const Pin& pin>
class LedPin {
 public:
  static void start() { Gpio(pin.port).make_output(pin.mask(), 0); }
  static void light(bool on) { Gpio(pin.port).write(pin.mask(), on ? pin.mask() : 0); }
};

}  // namespace ex9000::hal::stellaris
