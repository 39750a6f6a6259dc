// A UART without its FIFOs. Data sheets: LM3S6965 12.3 to 12.5, TM4C123GH6PM 14.3 to 14.5. Both
// microcontrollers contain ARM's PL011, and its manual (DDI 0183) specifies when the interrupts are raised
// and cleared.
#pragma once

#include <cstdint>
#include <optional>

#include "tests/mcu_model/gpio_port.hpp"
#include "tests/mcu_model/peripheral.hpp"
#include "tests/mcu_model/serial_wire.hpp"
#include "tests/mcu_model/system_control.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class UartPort final : public Peripheral {
 public:
  static constexpr std::uint32_t kData = 0x000;
  static constexpr std::uint32_t kFlags = 0x018;
  static constexpr std::uint32_t kIntegerDivisor = 0x024;
  static constexpr std::uint32_t kFractionalDivisor = 0x028;
  static constexpr std::uint32_t kLineControl = 0x02C;
  static constexpr std::uint32_t kControl = 0x030;
  static constexpr std::uint32_t kMask = 0x038;
  static constexpr std::uint32_t kRaw = 0x03C;
  static constexpr std::uint32_t kMasked = 0x040;
  static constexpr std::uint32_t kClear = 0x044;

  /// The pins of the UART, and their function number in GPIOPCTL.
  struct Pins {
    GpioPort* port = nullptr;
    unsigned receive = 0;
    unsigned transmit = 0;
    std::uint32_t function = 0;
  };

  UartPort(unsigned number, const SystemControl& clock, Timeline& timeline, Pins pins);

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;

  [[nodiscard]] bool receives_on(const GpioPort& port, unsigned pin) const {
    return pins_.port == &port && pins_.receive == pin;
  }
  /// Must be called when the level of the receive pin has changed.
  void receive_level(bool high);

  [[nodiscard]] Instant bit_time() const { return bit_time_; }
  [[nodiscard]] LineFormat format() const { return format_; }
  [[nodiscard]] std::uint32_t line_control() const { return line_control_; }
  [[nodiscard]] bool enabled() const { return (control_ & 1U) != 0; }
  /// Returns the number of bytes that were lost because the data register was not read in time.
  [[nodiscard]] unsigned overruns() const { return overruns_; }

 private:
  void transmit(std::uint8_t byte);
  void begin_character(std::uint8_t byte, Instant not_before);
  void character_is_over();
  void receive(SerialReceiver::Received received);
  void raise(std::uint32_t bits) {
    raw_ |= bits;
    tell_interrupt();
  }
  void tell_interrupt() { interrupt_line((raw_ & mask_) != 0); }

  const SystemControl& clock_;
  Timeline& timeline_;
  Pins pins_;
  std::uint32_t integer_divisor_ = 0;
  std::uint32_t fractional_divisor_ = 0;
  bool divisors_latched_ = true;
  std::uint32_t line_control_ = 0;
  std::uint32_t control_ = 0x300;
  std::uint32_t mask_ = 0;
  std::uint32_t raw_ = 0;
  Instant bit_time_{0};
  LineFormat format_ = LineFormat::k8N1;
  std::optional<std::uint8_t> transmit_holding_;
  std::optional<std::uint32_t> receive_holding_;
  bool overrun_ = false;
  unsigned overruns_ = 0;
  bool shifting_ = false;
  SerialSender sender_;
  SerialReceiver receiver_;
};

}  // namespace ex9000::registers
