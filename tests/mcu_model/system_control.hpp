// Clock tree, clock gates, causes of resets and software resets. Data sheets: LM3S6965 5.2 to 5.5,
// TM4C123GH6PM 5.2 to 5.6.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/mcu_model/chip.hpp"
#include "tests/mcu_model/peripheral.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

/// Causes of a reset; the values are bits of RESC.
enum class ResetCause : std::uint32_t {
  Pin = 0x01,
  PowerOn = 0x02,
  BrownOut = 0x04,
  Watchdog = 0x08,
  Software = 0x10
};

class SystemControl final : public Peripheral {
 public:
  static constexpr std::uint32_t kBase = 0x400F'E000;
  static constexpr std::uint32_t kRis = 0x050;
  static constexpr std::uint32_t kResc = 0x05C;
  static constexpr std::uint32_t kRcc = 0x060;
  static constexpr std::uint32_t kRcgc = 0x100;  ///< three words
  static constexpr std::uint32_t kSrcr = 0x040;  ///< three words

  SystemControl(const Chip& chip, Timeline& timeline);

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;

  /// Sets RESC to its value after a reset by `cause`. `before` is its value before the reset.
  void was_reset_by(ResetCause cause, std::uint32_t before);
  [[nodiscard]] std::uint32_t causes() const { return causes_; }

  /// Returns the period of the system clock.
  [[nodiscard]] Instant cycle() const { return cycle_; }
  /// Adds a function to call before a new period takes effect. Its argument is the new period.
  void on_clock_change(std::function<void(Instant cycle)> act) { on_clock_change_.push_back(std::move(act)); }
  /// Sets the function to call when the processor must wait for the crystal until `until`.
  void on_standstill(std::function<void(Instant until)> act) { on_standstill_ = std::move(act); }
  /// Sets the function to call when software sets a bit of SRCR`index`. The bit holds its peripheral in reset
  /// until software clears the bit.
  void on_software_reset(std::function<void(unsigned index, unsigned bit)> act) {
    on_software_reset_ = std::move(act);
  }
  [[nodiscard]] bool holds_in_reset(unsigned index, unsigned bit) const {
    return (resets_.at(index) >> bit & 1U) != 0;
  }

  /// The state of a clock gate. Shut: its bit in RCGC is clear. TooFresh: the bit is set, but not yet for
  /// long enough. Open: the bit has been set for long enough.
  enum class Gate : std::uint8_t { Shut, TooFresh, Open };
  [[nodiscard]] Gate gate(unsigned index, unsigned bit) const;

  /// Sets how long the crystal takes to start. The default is 2 ms.
  void set_crystal_start(Instant time) { crystal_start_ = time; }
  /// Sets how long the PLL takes to lock; with kNever, the PLL does not lock. The default is 500 us.
  void set_lock_time(Instant time) { lock_time_ = time; }

 private:
  void write_rcc(std::uint32_t value);
  void use_clock();
  [[nodiscard]] bool rcc_has(unsigned bit) const { return (rcc_ >> bit & 1U) != 0; }

  const Chip& chip_;
  Timeline& timeline_;
  std::uint32_t causes_ = 0;
  std::uint32_t rcc_;
  std::array<std::uint32_t, 3> gates_{};
  std::array<std::array<Instant, 32>, 3> opened_{};
  std::array<std::uint32_t, 3> resets_{};
  Instant cycle_;
  Instant crystal_start_ = std::chrono::milliseconds(2);
  Instant lock_time_ = std::chrono::microseconds(500);
  Instant crystal_swings_ = kNever;
  Alarm lock_;
  bool locked_ = false;
  std::vector<std::function<void(Instant)>> on_clock_change_;
  std::function<void(Instant)> on_standstill_;
  std::function<void(unsigned, unsigned)> on_software_reset_;
};

}  // namespace ex9000::registers
