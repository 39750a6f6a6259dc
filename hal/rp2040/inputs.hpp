// Input channels on pins, with interrupts at both edges.
#pragma once

#include <cstdint>

#include "hal/pins/settle.hpp"
#include "hal/rp2040/gpio.hpp"

namespace ex9000::hal::rp2040 {

/// `groups`: an array of PinGroup with the channels' pins from channel 0 on. `active_high`: high is logic 1.
template <const auto& groups, unsigned channels, bool active_high>
class InputPins {
 public:
  // --- the functions of hal/inputs.hpp ---

  static void make_inputs() { Gpio::make_input(kPins, !active_high); }

  static std::uint16_t start() {
    if constexpr (!any()) {
      return 0;
    }
    Gpio::watch_edges(kPins);
    const std::uint32_t levels = levels_in(settle(Gpio(), kPins, kPins)) ^ (active_high ? 0 : kPins);
    unsigned of_channels = 0;
    for (unsigned channel = 0; channel < channels; ++channel) {
      of_channels |= (levels >> kPinOf[channel] & 1U) << channel;
    }
    return static_cast<std::uint16_t>(of_channels);
  }

  // --- for the composition ---

  static constexpr bool any() { return channels != 0; }

  /// From the pins' interrupt: calls `deliver(channel, level)` for each channel that has had an edge.
  template <class Deliver>
  static void take_edges(Deliver deliver) {
    const Settled settled = settle(Gpio(), kPins, Gpio::edges());
    for (unsigned channel = 0; channel < channels; ++channel) {
      const std::uint32_t pin = 1U << kPinOf[channel];
      if ((flagged_in(settled) & pin) != 0) {
        deliver(channel, ((levels_in(settled) & pin) != 0) == active_high);
      }
    }
  }

 private:
  static constexpr auto kPinOf = pins_of_channels<channels>(groups);
  static constexpr std::uint32_t kPins = mask_of(kPinOf);
};

}  // namespace ex9000::hal::rp2040
