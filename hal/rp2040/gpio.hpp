// Pins. Source: RP2040 data sheet, 2.3.1 (SIO), 2.19 (GPIO, functions, interrupts and pads).
#pragma once

#include <array>
#include <cstdint>

#include "hal/registers/register.hpp"
#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

struct PinGroup {
  std::uint8_t first_pin;
  std::uint8_t count;

  [[nodiscard]] constexpr std::uint32_t mask() const { return ((1U << count) - 1U) << first_pin; }
};

/// The numbers of the pins of the channels, from channel 0 on. `groups`: an array of PinGroup.
template <unsigned channels, class Groups>
constexpr std::array<std::uint8_t, channels> pins_of_channels(const Groups& groups) {
  std::array<std::uint8_t, channels> result{};
  unsigned channel = 0;
  for (const PinGroup& group : groups) {
    for (unsigned i = 0; i < group.count && channel < channels; ++i, ++channel) {
      result[channel] = static_cast<std::uint8_t>(group.first_pin + i);
    }
  }
  return result;
}

/// Bit n is GPIOn.
template <class Numbers>
constexpr std::uint32_t mask_of(const Numbers& numbers) {
  std::uint32_t result = 0;
  for (const std::uint8_t number : numbers) {
    result |= 1U << number;
  }
  return result;
}

enum class Function : std::uint8_t { Uart = 2, I2c = 3, Software = 5 };

/// In `pins`, bit n is GPIOn; other pins do not change. For interrupts and the main loop. `write` reads the
/// output levels first, so meanwhile no interrupt may change the levels of the same pins.
class Gpio {
 public:
  [[nodiscard]] static std::uint32_t read(std::uint32_t pins) { return kLevels.read().value() & pins; }

  /// All change at the same time; a pin that does not change has no glitch.
  static void write(std::uint32_t pins, std::uint32_t levels) {
    kOutInvert.write(Bits<Out>((kOut.read().value() ^ levels) & pins));
  }
  static void set(std::uint32_t pins) { kOutSet.write(Bits<Out>(pins)); }
  static void clear(std::uint32_t pins) { kOutClear.write(Bits<Out>(pins)); }

  /// With the weak pull-up or pull-down. Choose the inactive level for an open pin.
  static void make_input(std::uint32_t pins, bool pull_up) {
    kDriveClear.write(Bits<Drive>(pins));
    make(pins, Function::Software, pull_up ? kInputPulledUp : kInputPulledDown);
  }

  /// 8 mA, initially `levels`; once per pin after a reset. No glitch: until its function is software control
  /// (SIO), a pin drives nothing, and its weak pull-down holds it low unless the circuit pulls it high.
  static void make_output(std::uint32_t pins, std::uint32_t levels) {
    write(pins, levels);
    kDriveSet.write(Bits<Drive>(pins));
    make(pins, Function::Software, kOutput8Ma);
  }

  /// With the weak pull-up, so that an open line is idle.
  static void make_peripheral(std::uint32_t pins, Function function) {
    make(pins, function, kPeripheralPulledUp);
  }

  /// `outputs`, a subset of `pins`, drive their output levels; the rest become inputs. The pulls stay.
  static void choose_outputs(std::uint32_t pins, std::uint32_t outputs) {
    kDriveClear.write(Bits<Drive>(pins & ~outputs));
    kDriveSet.write(Bits<Drive>(outputs));
  }

  // --- edges of GPIO0 to GPIO23; a register has four bits for each of eight pins ---

  /// Both edges. One that is already flagged causes an interrupt too.
  static void watch_edges(std::uint32_t pins) {
    for (std::uint32_t word = 0; word < kEdgeWords; ++word) {
      edge_enable(word).set(Bits<EdgeEnable>(spread(pins >> (kPinsAWord * word))));
    }
  }
  /// The watched pins with an edge since their last `clear_edges`.
  [[nodiscard]] static std::uint32_t edges() {
    std::uint32_t pins = 0;
    for (std::uint32_t word = 0; word < kEdgeWords; ++word) {
      pins |= gather(edge_status(word).read().value()) << (kPinsAWord * word);
    }
    return pins;
  }
  static void clear_edges(std::uint32_t pins) {
    for (std::uint32_t word = 0; word < kEdgeWords; ++word) {
      edge_clear(word).write(Bits<EdgeClear>(spread(pins >> (kPinsAWord * word))));
    }
  }

 private:
  struct Levels;
  struct Out;
  struct Drive;
  struct Control;
  struct Pad;
  struct EdgeClear;
  struct EdgeEnable;
  struct EdgeStatus;

  static constexpr Register<Levels> kLevels{0xD000'0004};
  static constexpr Register<Out> kOut{0xD000'0010};
  static constexpr Register<Out> kOutSet{0xD000'0014};
  static constexpr Register<Out> kOutClear{0xD000'0018};
  static constexpr Register<Out> kOutInvert{0xD000'001C};
  static constexpr Register<Drive> kDriveSet{0xD000'0024};
  static constexpr Register<Drive> kDriveClear{0xD000'0028};

  static constexpr SharedRegister<Control> control(std::uint32_t pin) {
    return SharedRegister<Control>(0x4001'4004U + 8U * pin);
  }
  static constexpr SharedRegister<Pad> pad(std::uint32_t pin) {
    return SharedRegister<Pad>(0x4001'C004U + 4U * pin);
  }
  static constexpr Register<EdgeClear> edge_clear(std::uint32_t word) {
    return Register<EdgeClear>(0x4001'40F0U + 4U * word);
  }
  static constexpr SharedRegister<EdgeEnable> edge_enable(std::uint32_t word) {
    return SharedRegister<EdgeEnable>(0x4001'4100U + 4U * word);
  }
  static constexpr Register<EdgeStatus> edge_status(std::uint32_t word) {
    return Register<EdgeStatus>(0x4001'4120U + 4U * word);
  }

  static constexpr Bits<Pad> kOutputDisable{1U << 7U};
  static constexpr Bits<Pad> kInputEnable{1U << 6U};
  static constexpr Bits<Pad> kDrive8Ma{0x2U << 4U};
  static constexpr Bits<Pad> kPullUp{1U << 3U};
  static constexpr Bits<Pad> kPullDown{1U << 2U};
  static constexpr Bits<Pad> kSchmittTrigger{1U << 1U};
  static constexpr Bits<Pad> kPeripheralPulledUp = kInputEnable | kPullUp | kSchmittTrigger | kDrive8Ma;
  static constexpr Bits<Pad> kInputPulledUp = kInputEnable | kPullUp | kSchmittTrigger | kDrive8Ma;
  static constexpr Bits<Pad> kInputPulledDown = kInputEnable | kPullDown | kSchmittTrigger | kDrive8Ma;
  static constexpr Bits<Pad> kOutput8Ma = kInputEnable | kPullDown | kSchmittTrigger | kDrive8Ma;

  /// The pad first, so that the new function never uses the pull of the old setting.
  [[gnu::noinline]] static void make(std::uint32_t pins, Function function, Bits<Pad> bits) {
    for (std::uint32_t pin = 0; pins != 0; ++pin, pins >>= 1U) {
      if ((pins & 1U) != 0) {
        pad(pin).write(bits);
        control(pin).write(Bits<Control>(static_cast<std::uint32_t>(function)));
      }
    }
  }

  static constexpr std::uint32_t kEdgeWords = 3;  // GPIO0 to GPIO23
  static constexpr std::uint32_t kPinsAWord = 8;
  static constexpr std::uint32_t kBothEdges = 0xC;

  /// Both edge bits of each pin in the lowest eight bits of `pins`.
  static std::uint32_t spread(std::uint32_t pins) {
    std::uint32_t bits = pins & 0xFFU;
    bits = (bits | bits << 12U) & 0x000F'000FU;
    bits = (bits | bits << 6U) & 0x0303'0303U;
    bits = (bits | bits << 3U) & 0x1111'1111U;
    return bits * kBothEdges;
  }
  /// In the lowest eight bits, the pins with an edge bit in `bits`.
  static std::uint32_t gather(std::uint32_t bits) {
    bits = (bits >> 2U | bits >> 3U) & 0x1111'1111U;
    bits = (bits | bits >> 3U) & 0x0303'0303U;
    bits = (bits | bits >> 6U) & 0x000F'000FU;
    return (bits | bits >> 12U) & 0xFFU;
  }
};

/// See hal/pins/single_pins.hpp.
struct Pin {
  std::uint8_t number;  ///< in the name of the pin, GPIO0 to GPIO29

  [[nodiscard]] constexpr std::uint32_t mask() const { return 1U << number; }
  [[gnu::always_inline]] void make_input(bool pull_up) const { Gpio::make_input(mask(), pull_up); }
  [[gnu::always_inline]] void make_output(bool level) const { Gpio::make_output(mask(), level ? mask() : 0); }
  [[gnu::always_inline]] void drive(bool level) const {
    if (level) {
      Gpio::set(mask());
    } else {
      Gpio::clear(mask());
    }
  }
  [[nodiscard]] bool read() const { return Gpio::read(mask()) != 0; }
};

}  // namespace ex9000::hal::rp2040
