// Output channels on pins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hal/stellaris/gpio.hpp"

namespace ex9000::hal::stellaris {

/// `groups`: an array of PinGroup with the channels' pins from channel 0 on. `active_high`: high energises.
template <const auto& groups, unsigned channels, bool active_high>
class OutputPins {
 public:
  static void start() {
    each_group(0, [](const Gpio& gpio, std::uint32_t pins, std::uint32_t levels) {
      gpio.make_output(pins, levels);
    });
  }

  /// One register per group with a channel: a few processor clocks apart, unless an interrupt occurs.
  static void drive(std::uint16_t energised) {
    each_group(energised,
               [](const Gpio& gpio, std::uint32_t pins, std::uint32_t levels) { gpio.write(pins, levels); });
  }

 private:
  /// Pins in the groups before `groups[group]`.
  static constexpr unsigned before(std::size_t group) {
    unsigned sum = 0;
    for (std::size_t i = 0; i < group; ++i) {
      sum += groups[i].count;
    }
    return sum;
  }

  template <std::size_t index, class Act>
  static void act_on(std::uint32_t energised, Act act) {
    constexpr PinGroup kGroup = groups[index];
    constexpr unsigned kFirst = before(index);
    if constexpr (kFirst < channels) {
      constexpr unsigned kHere = channels - kFirst < kGroup.count ? channels - kFirst : kGroup.count;
      constexpr std::uint32_t kPins = ((1U << kHere) - 1U) << kGroup.first_pin;
      const std::uint32_t bits = kFirst < kGroup.first_pin ? energised << (kGroup.first_pin - kFirst)
                                                           : energised >> (kFirst - kGroup.first_pin);
      act(Gpio(kGroup.port), kPins, (active_high ? bits : ~bits) & kPins);
    }
  }

  template <class Act, std::size_t... index>
  static void each(std::uint32_t energised, Act act, std::index_sequence<index...> /*unused*/) {
    (act_on<index>(energised, act), ...);
  }
  template <class Act>
  static void each_group(std::uint32_t energised, Act act) {
    each(energised, act, std::make_index_sequence<groups.size()>());
  }
};

}  // namespace ex9000::hal::stellaris
