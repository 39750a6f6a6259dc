// Input channels on pins, with interrupts at both edges.
#pragma once

#include <cstdint>

#include "hal/rp2040/gpio.hpp"

namespace ex9000::hal::rp2040 {

/// `groups` is an array of PinGroup that contains the pins of the channels in order, from channel 0 on.
/// `active_high`: a high pin is logic 1.
template <const auto& groups, unsigned channels, bool active_high>
class InputPins {
 public:
  /// Enables edge interrupts and returns the levels, bit n is channel n. Each later edge is flagged. An edge
  /// during the read would count as two edges, so the levels are read until no edge has occurred during the
  /// read.
  static std::uint16_t start() {
    Gpio::make_input(kPins, !active_high);
    Gpio::watch_edges(kPins);
    return static_cast<std::uint16_t>(settle(kPins).levels >> kFirst & ((1U << channels) - 1U));
  }

  static constexpr bool any() { return channels != 0; }

  /// Calls `deliver(channel, level)` for each channel that has had an edge. For the interrupt of the pins.
  template <class Deliver>
  static void take_edges(Deliver deliver) {
    const Settled settled = settle(Gpio::edges());
    std::uint32_t flagged = settled.flagged >> kFirst;
    std::uint32_t levels = settled.levels >> kFirst;
    for (unsigned channel = 0; flagged != 0; ++channel, flagged >>= 1U, levels >>= 1U) {
      if ((flagged & 1U) != 0) {
        deliver(channel, (levels & 1U) != 0);
      }
    }
  }

 private:
  static constexpr unsigned kFirst = groups[0].first_pin;
  static constexpr std::uint32_t kPins = ((1U << channels) - 1U) << kFirst;
  static_assert(channels <= groups[0].count, "the inputs of a model must be in one group of pins");

  struct Settled {
    std::uint32_t flagged;
    std::uint32_t levels;  ///< 1: logic 1
  };

  /// Clears the flags of `flagged` and those of new edges, and reads the levels after the last of these
  /// edges. This is repeated because an edge between flag and level would count twice: now because of its
  /// level, and later because of its flag.
  static Settled settle(std::uint32_t flagged) {
    Settled settled{0, 0};
    do {
      settled.flagged |= flagged;
      Gpio::clear_edges(flagged);
      settled.levels = Gpio::read(kPins) ^ (active_high ? 0 : kPins);
      flagged = Gpio::edges() & kPins;
    } while (flagged != 0);
    return settled;
  }
};

}  // namespace ex9000::hal::rp2040
