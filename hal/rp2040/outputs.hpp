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
  static constexpr unsigned kFirst = groups[0].first_pin;
  static constexpr std::uint32_t kPins = ((1U << channels) - 1U) << kFirst;

  static constexpr bool adjacent() {
    unsigned channel = 0;
    for (const PinGroup& group : groups) {
      if (channel < channels && group.first_pin != kFirst + channel) {
        return false;
      }
      channel += group.count;
    }
    return true;
  }
  static_assert(adjacent(), "the outputs of a model must have adjacent pins");

  static std::uint32_t levels(std::uint32_t energised) {
    return (active_high ? energised << kFirst : ~(energised << kFirst)) & kPins;
  }
};

}  // namespace ex9000::hal::rp2040
