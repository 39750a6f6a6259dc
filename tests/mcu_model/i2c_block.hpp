// I2C master 0, simulated bit by bit on its wires. Data sheets: LM3S6965 14.3 to 14.5, TM4C123GH6PM 16.3 to
// 16.5.
#pragma once

#include <cstdint>
#include <deque>

#include "tests/mcu_model/chip.hpp"
#include "tests/mcu_model/gpio_port.hpp"
#include "tests/mcu_model/peripheral.hpp"
#include "tests/mcu_model/system_control.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

/// Behaviour that the data sheets do not specify.
struct I2cBehaviour {
  bool stop_interrupts = false;     ///< a STOP without a byte raises an interrupt
  bool stops_after_error = false;   ///< the block sends a requested STOP even if an acknowledge is missing
  bool waits_for_free_bus = false;  ///< a START on a busy bus waits for a reset; false: it loses arbitration
  bool loss_is_no_error = false;    ///< lost arbitration does not set the error bit
};

class I2cBlock final : public Peripheral {
 public:
  static constexpr std::uint32_t kBase = 0x4002'0000;
  static constexpr std::uint32_t kTarget = 0x000;
  static constexpr std::uint32_t kControl = 0x004;
  static constexpr std::uint32_t kData = 0x008;
  static constexpr std::uint32_t kPeriod = 0x00C;
  static constexpr std::uint32_t kMask = 0x010;
  static constexpr std::uint32_t kRaw = 0x014;
  static constexpr std::uint32_t kMasked = 0x018;
  static constexpr std::uint32_t kClear = 0x01C;
  static constexpr std::uint32_t kConfiguration = 0x020;

  static constexpr unsigned kClockPin = 2;  ///< on port B, like the data pin
  static constexpr unsigned kDataPin = 3;
  static constexpr std::uint32_t kFunction = 3;

  I2cBlock(const Chip& chip, const SystemControl& clock, Timeline& timeline, GpioPort& port_b, PortNets& nets,
           I2cBehaviour behaviour);

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void software_reset();
  /// Must be called when the level of the clock line has changed.
  void look_at_clock();

  /// Returns the duration of a bit, as set in the registers.
  [[nodiscard]] Instant bit_time() const { return 20 * (period_ + 1) * clock_.cycle(); }

 private:
  enum class Move : std::uint8_t { Start, Zero, One, Take, TakeAcknowledge, Stop };

  void command(std::uint32_t bits);
  void check_pins() const;
  void queue_byte(std::uint8_t byte);
  void begin_move();
  void go_on();
  void clock_is_high();
  void end_bit();
  void move_is_over();
  void fail(std::uint32_t bits);
  void finish();
  void clock(bool high);
  void data(bool high);
  [[nodiscard]] bool clock_high() const { return nets_.at(kClockPin).level(); }
  [[nodiscard]] bool data_high() const { return nets_.at(kDataPin).level(); }
  void tell_interrupt() { interrupt_line((raw_ & mask_) != 0); }

  const Chip& chip_;
  const SystemControl& clock_;
  GpioPort& port_;
  PortNets& nets_;
  I2cBehaviour behaviour_;

  std::uint32_t target_ = 0;
  std::uint32_t data_ = 0;
  std::uint32_t period_ = 1;
  std::uint32_t mask_ = 0;
  std::uint32_t raw_ = 0;
  std::uint32_t configuration_ = 0;
  std::uint32_t status_ = 0;  ///< error bits of the status register
  bool busy_ = false;
  bool owns_bus_ = false;
  bool receiving_ = false;
  bool addressing_ = false;
  bool stop_asked_ = false;
  bool only_stopping_ = false;
  std::deque<Move> moves_;
  unsigned phase_ = 0;
  bool waits_for_clock_ = false;
  std::uint8_t taken_ = 0;
  unsigned taken_bits_ = 0;
  Alarm next_;
};

}  // namespace ex9000::registers
