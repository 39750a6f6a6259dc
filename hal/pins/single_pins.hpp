// INIT*, the status LED and the driver enable of the RS-485 transceiver: one pin each. A family's `Pin` has
// these functions, for interrupts and the main loop:
//     void make_input(bool pull_up) const    Digital, with its weak pull-up or pull-down.
//     void make_output(bool level) const     With this level and no other before. Once after reset.
//     void drive(bool level) const           One write to a register: an interrupt and the main loop may both
//                                            drive a pin, or drive two pins of a port.
//     bool read() const
#pragma once

namespace ex9000::hal {

/// See hal/init_switch.hpp.
template <const auto& pin>
class InitPin {
 public:
  static void start() { pin.make_input(true); }
  [[nodiscard]] static bool asserted() { return !pin.read(); }
};

/// On while its pin is high. See hal/status_led.hpp.
template <const auto& pin>
class LedPin {
 public:
  static void start() { pin.make_output(false); }
  static void light(bool on) { pin.drive(on); }
};

/// On while its pin is high. The main loop turns it on, an interrupt on and off. It cannot tell whether a
/// start bit is on the line.
template <const auto& pin>
class DriverEnablePin {
 public:
  static void start() { pin.make_output(false); }
  static void drive(bool on) { pin.drive(on); }
  static bool low() { return false; }
};

/// `receive`: the UART's pin, if its level can be read although the UART owns it.
template <const auto& driver_enable, const auto& receive>
class Transceiver : public DriverEnablePin<driver_enable> {
 public:
  static bool low() { return !receive.read(); }
};

/// The driver enable of a board whose transceiver switches its direction automatically. `drive` does nothing,
/// but the line is still sending until the last stop bit has ended, and until then ignores what it receives.
struct NoPin {
  static void make_output(bool /*level*/) {}
  static void drive(bool /*level*/) {}
};

}  // namespace ex9000::hal
