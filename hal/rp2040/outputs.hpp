// Output channels on pins.
#pragma once

#include <cstdint>

#include "hal/rp2040/gpio.hpp"

namespace ex9000::hal::rp2040 {

/// `groups`: an array of PinGroup with the channels' pins from channel 0 on. `active_high`: high energises.
template <const auto& groups, unsigned channels, bool active_high>
class OutputPins {
 public:
  static void start() { Gpio::make_output(kPins, levels(0)); }

  /// One register, so that all channels change at the same time.
  static void drive(std::uint16_t energised) { Gpio::write(kPins, levels(energised)); }

 private:
  static constexpr auto kPinOf = pins_of_channels<channels>(groups);
  static constexpr std::uint32_t kPins = mask_of(kPinOf);

  /// Whether the pins ascend with the channels, without a gap.
  static constexpr bool in_order() {
    for (unsigned channel = 0; channel < channels; ++channel) {
      if (kPinOf[channel] != kPinOf[0] + channel) {
        return false;
      }
    }
    return true;
  }

  static std::uint32_t levels(std::uint32_t energised) {
    const std::uint32_t pins = pins_of(energised);
    return (active_high ? pins : ~pins) & kPins;
  }

  static std::uint32_t pins_of(std::uint32_t energised) {
    if constexpr (channels == 0) {
      return 0;
    } else if constexpr (in_order()) {
      return energised << kPinOf[0];
    } else {
      std::uint32_t pins = 0;
      for (unsigned channel = 0; channel < channels; ++channel) {
        pins |= (energised >> channel & 1U) << kPinOf[channel];
      }
      return pins;
    }
  }
};

}  // namespace ex9000::hal::rp2040
