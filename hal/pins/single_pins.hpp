// INIT*, the status LED, and the driver enable of the RS-485 transceiver: one pin each. The `Pin` of a family
// of microcontrollers has these functions. Interrupts and the main loop may call them.
//
//     void make_input(bool pull_up) const
//         Makes the pin a digital input, with its weak pull-up if `pull_up` is true, else with its weak
//         pull-down.
//     void make_output(bool level) const
//         Makes the pin an output with this level. Once after reset; the pin has no other level in between.
//     void drive(bool level) const
//         Sets the level of an output with one write to a register, so an interrupt and the main loop may
//         both drive a pin, or drive two pins of one port.
//     bool read() const
//         Returns the level.
#pragma once

namespace ex9000::hal {

/// INIT*, active low. See hal/init_switch.hpp.
template <const auto& pin>
class InitPin {
 public:
  static void start() { pin.make_input(true); }
  [[nodiscard]] static bool asserted() { return !pin.read(); }
};

/// A status LED that is on while its pin is high. See hal/status_led.hpp.
template <const auto& pin>
class LedPin {
 public:
  static void start() { pin.make_output(false); }
  static void light(bool on) { pin.drive(on); }
};

/// An RS-485 driver that is on while its pin is high. The main loop turns it on, and an interrupt turns it
/// off.
template <const auto& pin>
class DriverEnablePin {
 public:
  static void start() { pin.make_output(false); }
  static void drive(bool on) { pin.drive(on); }
};

}  // namespace ex9000::hal
