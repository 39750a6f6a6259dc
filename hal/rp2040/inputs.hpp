// Input channels on pins, with interrupts at both edges.
#pragma once

#include <array>
#include <cstdint>

#include "hal/rp2040/gpio.hpp"

namespace ex9000::hal::rp2040 {

/// `groups` is an array of PinGroup that contains the pins of the channels in order, from channel 0 on.
/// `active_high`: whether a high pin is logic 1.
template <const auto& groups, unsigned channels, bool active_high>
class InputPins {
 public:
  /// Makes the pins inputs. Call this once, at least kPullsSettle before `start`.
  static void make_inputs() { Gpio::make_input(kPins, !active_high); }

  /// Enables edge interrupts and returns the levels; bit n is channel n. Each edge after the read of these
  /// levels is flagged.
  static std::uint16_t start() {
    Gpio::watch_edges(kPins);
    const std::uint32_t levels = settle(kPins).levels;
    unsigned of_channels = 0;
    for (unsigned channel = 0; channel < channels; ++channel) {
      of_channels |= (levels >> kPinOf[channel] & 1U) << channel;
    }
    return static_cast<std::uint16_t>(of_channels);
  }

  static constexpr bool any() { return channels != 0; }

  /// Calls `deliver(channel, level)` for each channel that has had an edge. Call this from the interrupt of
  /// the pins.
  template <class Deliver>
  static void take_edges(Deliver deliver) {
    const Settled settled = settle(Gpio::edges());
    for (unsigned channel = 0; channel < channels; ++channel) {
      const std::uint32_t pin = 1U << kPinOf[channel];
      if ((settled.flagged & pin) != 0) {
        deliver(channel, (settled.levels & pin) != 0);
      }
    }
  }

 private:
  /// Returns the pin of each channel.
  static constexpr std::array<std::uint8_t, channels> pins_of_channels() {
    std::array<std::uint8_t, channels> result{};
    unsigned channel = 0;
    for (const PinGroup& group : groups) {
      for (unsigned i = 0; i < group.count && channel < channels; ++i, ++channel) {
        result[channel] = static_cast<std::uint8_t>(group.first_pin + i);
      }
    }
    return result;
  }
  static constexpr std::array<std::uint8_t, channels> kPinOf = pins_of_channels();

  static constexpr std::uint32_t mask() {
    std::uint32_t result = 0;
    for (const std::uint8_t pin : kPinOf) {
      result |= 1U << pin;
    }
    return result;
  }
  static constexpr std::uint32_t kPins = mask();

  struct Settled {
    std::uint32_t flagged;  ///< bit n is GPIOn
    std::uint32_t levels;   ///< bit n is GPIOn; 1 = logic 1
  };

  /// Clears the edge flags of the pins in `flagged`, and then reads the levels. If a new edge is flagged,
  /// repeats both steps. Without the repetition, an edge between the two steps would count twice: now because
  /// of its level, and later because of its flag. Returns all flagged pins and the last levels.
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
