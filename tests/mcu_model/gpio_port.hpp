// One port of eight pins. Data sheets: LM3S6965 8.3 to 8.5, TM4C123GH6PM 10.3 to 10.5.
#pragma once

#include <array>
#include <cstdint>

#include "tests/mcu_model/chip.hpp"
#include "tests/mcu_model/net.hpp"
#include "tests/mcu_model/peripheral.hpp"

namespace ex9000::registers {

using PortNets = std::array<Net, 8>;

class GpioPort final : public Peripheral {
 public:
  static constexpr std::uint32_t kDirection = 0x400;
  static constexpr std::uint32_t kSense = 0x404;
  static constexpr std::uint32_t kBothEdges = 0x408;
  static constexpr std::uint32_t kMask = 0x410;
  static constexpr std::uint32_t kRaw = 0x414;
  static constexpr std::uint32_t kMasked = 0x418;
  static constexpr std::uint32_t kClear = 0x41C;
  static constexpr std::uint32_t kAlternate = 0x420;
  static constexpr std::uint32_t kDrive2 = 0x500;
  static constexpr std::uint32_t kDrive4 = 0x504;
  static constexpr std::uint32_t kDrive8 = 0x508;
  static constexpr std::uint32_t kOpenDrain = 0x50C;
  static constexpr std::uint32_t kPullUp = 0x510;
  static constexpr std::uint32_t kPullDown = 0x514;
  static constexpr std::uint32_t kEnable = 0x51C;
  static constexpr std::uint32_t kAnalog = 0x528;
  static constexpr std::uint32_t kControl = 0x52C;

  /// `letter` is 'A' to 'F', or 'G' if `chip` has seven ports. The nets must outlive the port. The
  /// constructor releases all nets, but connects the pull-ups of the debug pins. The destructor releases all
  /// nets.
  GpioPort(const Chip& chip, char letter, PortNets& nets);
  ~GpioPort() override;

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;

  /// Sets how a peripheral drives the pin. The setting has an effect while GPIOAFSEL and GPIODEN are set for
  /// the pin, whatever GPIOPCTL contains.
  void alternate(unsigned pin, Drive drive) {
    alternate_drive_.at(pin) = drive;
    drive_pin(pin);
  }
  /// Returns whether GPIOAFSEL and GPIODEN are set for the pin and, on a chip with GPIOPCTL, whether the
  /// pin's field in GPIOPCTL contains `function`.
  [[nodiscard]] bool given_to(unsigned pin, std::uint32_t function) const;
  /// Returns the value of a register without a bus access.
  [[nodiscard]] std::uint32_t peek(std::uint32_t offset) const {
    return const_cast<GpioPort*>(this)->read(offset);
  }

  /// Must be called when the level of the pin has changed.
  void look_at(unsigned pin);

 private:
  [[nodiscard]] static std::uint32_t base_of(char letter);
  std::uint32_t& stored(std::uint32_t offset);
  void check_lock(std::uint32_t offset, std::uint32_t changed) const;
  void drive_pin(unsigned pin);
  static constexpr std::uint32_t kAll = 0xFF;
  void drive_pins(std::uint32_t pins);
  void tell_interrupt() { interrupt_line((raw_ & mask_) != 0); }

  const Chip& chip_;
  PortNets& nets_;
  std::uint32_t locked_;  ///< pins that GPIOCR protects; the model has no GPIOCR, so they stay locked
  std::uint32_t data_ = 0;
  std::uint32_t direction_ = 0;
  std::uint32_t sense_ = 0;
  std::uint32_t both_edges_ = 0;
  std::uint32_t mask_ = 0;
  std::uint32_t raw_ = 0;
  std::uint32_t function_;
  std::uint32_t drive_2_ = 0xFF;
  std::uint32_t drive_4_ = 0;
  std::uint32_t drive_8_ = 0;
  std::uint32_t open_drain_ = 0;
  std::uint32_t pull_up_;
  std::uint32_t pull_down_ = 0;
  std::uint32_t enable_;
  std::uint32_t analog_ = 0;
  std::uint32_t control_ = 0;
  std::uint32_t input_ = 0;  ///< the levels of the enabled pins; 0 for the other pins
  std::array<Drive, 8> alternate_drive_{};
};

}  // namespace ex9000::registers
