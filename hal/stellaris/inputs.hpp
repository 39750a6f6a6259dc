// Input channels on pins, with interrupts at both edges.
#pragma once

#include <array>
#include <cstdint>

#include "hal/pins/settle.hpp"
#include "hal/stellaris/gpio.hpp"

namespace ex9000::hal::stellaris {

/// `groups`: an array of PinGroup with the channels' pins from channel 0 on. `active_high`: high is logic 1.
template <const auto& groups, unsigned channels, bool active_high>
class InputPins {
 public:
  // --- the functions of hal/inputs.hpp ---

  static void make_inputs() {
    unsigned first = 0;
    for (const PinGroup& group : groups) {
      if (first < channels) {
        Gpio(group.port).make_input(group.mask(), !active_high);
        first += group.count;
      }
    }
  }

  static std::uint16_t start() {
    unsigned first = 0;
    unsigned levels = 0;
    for (const PinGroup& group : groups) {
      if (first < channels) {
        const Gpio gpio(group.port);
        const std::uint32_t pins = group.mask();
        gpio.watch_edges(pins);
        levels |= (logic(levels_in(settle(gpio, pins, pins))) & pins) >> group.first_pin << first;
        first += group.count;
      }
    }
    return static_cast<std::uint16_t>(levels & ((1U << channels) - 1U));
  }

  // --- for the composition ---

  static constexpr bool on(Port port) {
    unsigned first = 0;
    for (const PinGroup& group : groups) {
      if (group.port == port && first < channels) {
        return true;
      }
      first += group.count;
    }
    return false;
  }

  /// From the port's interrupt: calls `deliver(channel, level)` for each channel on `port` that has had an
  /// edge. Pins of the last group without a channel deliver a `channel` from `channels` on.
  template <Port port, class Deliver>
  static void take_edges(Deliver deliver) {
    static constexpr std::array<std::uint8_t, 8> kChannels = channels_of(port);
    take_edges(Gpio(port), kChannels.data(), deliver);
  }

 private:
  template <class Deliver>
  [[gnu::noinline]] static void take_edges(Gpio gpio, const std::uint8_t* channel, Deliver deliver) {
    const Settled settled = settle(gpio, kAllPins, gpio.edges());
    std::uint32_t levels = logic(levels_in(settled));
    for (std::uint32_t flagged = flagged_in(settled); flagged != 0;
         flagged >>= 1U, levels >>= 1U, ++channel) {
      if ((flagged & 1U) != 0) {
        deliver(*channel, (levels & 1U) != 0);
      }
    }
  }

  static constexpr std::uint32_t kAllPins = 0xFF;

  static std::uint32_t logic(std::uint32_t levels) { return active_high ? levels : ~levels; }

  /// Of each pin of a port; unused for pins in no group, which are not watched.
  static constexpr std::array<std::uint8_t, 8> channels_of(Port port) {
    std::array<std::uint8_t, 8> result{};
    unsigned channel = 0;
    for (const PinGroup& group : groups) {
      for (unsigned i = 0; i < group.count; ++i, ++channel) {
        if (group.port == port) {
          result[group.first_pin + i] = static_cast<std::uint8_t>(channel);
        }
      }
    }
    return result;
  }
};

}  // namespace ex9000::hal::stellaris
