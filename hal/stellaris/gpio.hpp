// Pins. Sources: LM3S6965 data sheet, 8.3 to 8.5; TM4C123GH6PM data sheet, 10.3 to 10.5. The APB aperture of
// the TM4C has the registers of the LM3S6965 and more, for example GPIOPCTL.
#pragma once

#include <cstdint>

#include "hal/registers/register.hpp"

namespace ex9000::hal::stellaris {

enum class Family : std::uint8_t {
  Lm3s,  ///< a pin has at most one peripheral function
  Tm4c,  ///< GPIOPCTL selects one of several peripheral functions
};

enum class Port : std::uint8_t { A, B, C, D, E, F, G };

struct PinGroup {
  Port port;
  std::uint8_t first_pin;
  std::uint8_t count;

  [[nodiscard]] constexpr std::uint32_t mask() const { return ((1U << count) - 1U) << first_pin; }
};

/// One port. In masks, bit n is pin n.
class Gpio {
 public:
  constexpr explicit Gpio(Port port)
      : base_(port < Port::E ? 0x4000'4000U + static_cast<std::uint32_t>(port) * 0x1000U
                             : 0x4002'4000U + (static_cast<std::uint32_t>(port) - 4U) * 0x1000U) {}

  /// Bits 2 to 9 of the data register's 256 addresses select the pins: a write needs no read to preserve the
  /// others, so no interrupt can change them in between.
  [[nodiscard]] std::uint32_t read(std::uint32_t pins) const { return data(pins).read().value(); }
  void write(std::uint32_t pins, std::uint32_t levels) const { data(pins).write(Bits<Data>(levels)); }

  /// With the weak pull-up or pull-down. Choose the inactive level for an open pin.
  void make_input(std::uint32_t pins, bool pull_up) const { make_input_of(*this, pins, pull_up); }
  [[gnu::noinline]] static void make_input_of(Gpio port, std::uint32_t pins, bool pull_up) {
    (pull_up ? port.pull_up_register() : port.pull_down_register()).set(Bits<Pull>(pins));
    port.direction().clear(Bits<Direction>(pins));
    port.digital_enable().set(Bits<DigitalEnable>(pins));
  }

  /// 8 mA, with the initial `levels`. No glitch if these are inactive: until it is enabled, a pin drives
  /// nothing, and the circuit pulls it to its inactive level.
  void make_output(std::uint32_t pins, std::uint32_t levels) const { make_output_of(*this, pins, levels); }
  [[gnu::noinline]] static void make_output_of(Gpio port, std::uint32_t pins, std::uint32_t levels) {
    port.direction().set(Bits<Direction>(pins));
    port.write(pins, levels);
    port.drive_8_ma().set(Bits<Drive>(pins));
    port.digital_enable().set(Bits<DigitalEnable>(pins));
  }

  /// `function`: number in GPIOPCTL, only for Tm4c.
  template <Family family, std::uint32_t pins, std::uint32_t function>
  void make_peripheral() const {
    if constexpr (family == Family::Tm4c) {
      constexpr std::uint32_t kNibbles = one_a_nibble(pins);
      port_control().write(port_control().read().without(Bits<PortControl>(kNibbles * 0xFU)) |
                           Bits<PortControl>(kNibbles * function));
    }
    alternate_function().set(Bits<AlternateFunction>(pins));
    digital_enable().set(Bits<DigitalEnable>(pins));
  }
  void take_from_peripheral(std::uint32_t pins) const {
    alternate_function().clear(Bits<AlternateFunction>(pins));
  }
  void set_open_drain(std::uint32_t pins) const { open_drain().set(Bits<OpenDrain>(pins)); }
  /// The other `pins` become inputs.
  void choose_outputs(std::uint32_t pins, std::uint32_t outputs) const {
    direction().write(direction().read().without(Bits<Direction>(pins)) | Bits<Direction>(outputs));
  }

  // --- edges ---

  /// Both edges. One that is already flagged causes an interrupt too.
  void watch_edges(std::uint32_t pins) const {
    both_edges().set(Bits<BothEdges>(pins));
    interrupt_mask().set(Bits<InterruptMask>(pins));
  }
  /// The watched pins whose edge flag is set.
  [[nodiscard]] std::uint32_t edges() const { return masked_interrupt_status().read().value(); }
  void clear_edges(std::uint32_t pins) const { interrupt_clear().write(Bits<InterruptClear>(pins)); }

 private:
  /// Bit 4n is bit n of `pins`: GPIOPCTL has four bits for each pin.
  static constexpr std::uint32_t one_a_nibble(std::uint32_t pins) {
    std::uint32_t nibbles = 0;
    for (std::uint32_t pin = 0; pin < 8; ++pin) {
      nibbles |= (pins >> pin & 1U) << (4U * pin);
    }
    return nibbles;
  }

  struct Data;
  struct Direction;
  struct BothEdges;
  struct InterruptMask;
  struct MaskedInterruptStatus;
  struct InterruptClear;
  struct AlternateFunction;
  struct Drive;
  struct OpenDrain;
  struct Pull;
  struct DigitalEnable;
  struct PortControl;

  [[nodiscard]] constexpr Register<Data> data(std::uint32_t pins) const {
    return Register<Data>(base_ + (pins << 2U));
  }
  [[nodiscard]] constexpr Register<Direction> direction() const { return Register<Direction>(base_ + 0x400); }
  [[nodiscard]] constexpr Register<BothEdges> both_edges() const {
    return Register<BothEdges>(base_ + 0x408);
  }
  [[nodiscard]] constexpr Register<InterruptMask> interrupt_mask() const {
    return Register<InterruptMask>(base_ + 0x410);
  }
  [[nodiscard]] constexpr Register<MaskedInterruptStatus> masked_interrupt_status() const {
    return Register<MaskedInterruptStatus>(base_ + 0x418);
  }
  [[nodiscard]] constexpr Register<InterruptClear> interrupt_clear() const {
    return Register<InterruptClear>(base_ + 0x41C);
  }
  [[nodiscard]] constexpr Register<AlternateFunction> alternate_function() const {
    return Register<AlternateFunction>(base_ + 0x420);
  }
  [[nodiscard]] constexpr Register<Drive> drive_8_ma() const { return Register<Drive>(base_ + 0x508); }
  [[nodiscard]] constexpr Register<OpenDrain> open_drain() const {
    return Register<OpenDrain>(base_ + 0x50C);
  }
  [[nodiscard]] constexpr Register<Pull> pull_up_register() const { return Register<Pull>(base_ + 0x510); }
  [[nodiscard]] constexpr Register<Pull> pull_down_register() const { return Register<Pull>(base_ + 0x514); }
  [[nodiscard]] constexpr Register<DigitalEnable> digital_enable() const {
    return Register<DigitalEnable>(base_ + 0x51C);
  }
  [[nodiscard]] constexpr Register<PortControl> port_control() const {
    return Register<PortControl>(base_ + 0x52C);
  }

  std::uint32_t base_;
};

/// See hal/pins/single_pins.hpp.
struct Pin {
  Port port;
  std::uint8_t number;  ///< 0 to 7

  [[nodiscard]] constexpr std::uint32_t mask() const { return 1U << number; }
  [[gnu::always_inline]] void make_input(bool pull_up) const { Gpio(port).make_input(mask(), pull_up); }
  [[gnu::always_inline]] void make_output(bool level) const {
    Gpio(port).make_output(mask(), level ? mask() : 0);
  }
  [[gnu::always_inline]] void drive(bool level) const { Gpio(port).write(mask(), level ? mask() : 0); }
  [[nodiscard]] bool read() const { return Gpio(port).read(mask()) != 0; }
};

}  // namespace ex9000::hal::stellaris
