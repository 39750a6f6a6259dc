// The watchdog, the tick that drives it, resets of the chip and their reasons. Source: RP2040 data sheet,
// 4.7, 2.12.7, 2.13.5 and erratum RP2040-E1.
#pragma once

#include <cstdint>

#include "firmware/reset_reason.hpp"
#include "hal/rp2040/shared_register.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal::rp2040 {

class WatchdogRegisters {
 public:
  /// Resets the MCU, except its oscillators, immediately and does not return. Interrupts, faults and the main
  /// loop may call this.
  [[noreturn]] static void reset_chip() {
    kResetBy.write(kAllButOscillators);
    kControl.set(kTrigger);
    for (;;) {
    }
  }

  /// Returns the reason of the last reset. Call this before the watchdog starts.
  [[nodiscard]] static ResetReason reset_reason() {
    constexpr Bits<Reason> kTimeout(1U << 0U);
    constexpr Bits<Reason> kRequest(1U << 1U);
    constexpr Bits<ChipReset> kSupply(1U << 8U);
    constexpr Bits<ChipReset> kRunPin(1U << 16U);
    const Bits<Reason> reason = kReason.read();
    if (reason.has(kRequest | kTimeout)) {
      // Only images write the mark. The boot ROM also resets the chip with the watchdog, after it has copied
      // an image to the flash. In an image, only `fault_handler` requests a reset.
      return kMark.read().value() != kOfAnImage.value() ? ResetReason::Software
             : reason.has(kRequest)                     ? ResetReason::Fault
                                                        : ResetReason::ModuleWatchdog;
    }
    // A reset by the watchdog does not change the bits of the last chip-level reset, so these bits are valid
    // only if the watchdog has not reset the chip.
    const Bits<ChipReset> chip_reset = kChipReset.read();
    return chip_reset.has(kSupply)   ? ResetReason::PowerOn
           : chip_reset.has(kRunPin) ? ResetReason::ResetPin
                                     : ResetReason::Unknown;  // the rescue reset of the debug port
  }

 protected:
  struct Control;
  struct Load;
  struct Reason;
  struct Mark;
  struct Tick;
  struct ResetBy;
  struct ChipReset;
  static constexpr SharedRegister<Control> kControl{0x4005'8000};
  static constexpr SharedRegister<Load> kLoad{0x4005'8004};
  static constexpr SharedRegister<Reason> kReason{0x4005'8008};
  /// The first of eight scratch registers. A chip-level reset clears it, and a reset by the watchdog does
  /// not. The boot sequence (2.8.1) uses only the last four scratch registers.
  static constexpr SharedRegister<Mark> kMark{0x4005'800C};
  static constexpr SharedRegister<Tick> kTick{0x4005'802C};
  static constexpr SharedRegister<ResetBy> kResetBy{0x4001'0008};
  static constexpr SharedRegister<ChipReset> kChipReset{0x4006'4008};
  static constexpr Bits<Control> kEnable{1U << 30U};
  static constexpr Bits<Control> kTrigger{1U << 31U};
  static constexpr Bits<Tick> kTickEnable{1U << 9U};
  static constexpr Bits<Mark> kOfAnImage{0x4558'9000};  ///< any value that other software does not write
  /// Without these bits, a reset by the watchdog would leave the peripherals as they are. The oscillators
  /// need no reset.
  static constexpr Bits<ResetBy> kAllButOscillators{0x1'FFFC};
};

/// `reference`: frequency of the reference clock in MHz while the crystal is the source of this clock.
template <std::uint32_t reference>
class HardwareWatchdog : public WatchdogRegisters {
 public:
  /// Starts the tick, which drives the watchdog and the timer, and then starts the watchdog. The watchdog
  /// runs until the next reset. While the ring oscillator is the source of the reference clock, each tick and
  /// the countdown can take up to twelve times as long as with a crystal of 12 MHz.
  static void start() {
    kMark.write(kOfAnImage);
    kTick.write(Bits<Tick>(reference) | kTickEnable);
    kControl.clear(kEnable);
    kResetBy.write(kAllButOscillators);
    feed();
    kControl.set(kEnable);
  }

  static void feed() { kLoad.write(Bits<Load>(kCountdown)); }

 private:
  static constexpr Duration kPeriod = milliseconds(1500);
  static_assert(kPeriod.microseconds() < kWatchdogPeriod.microseconds(), "the period is too long");
  /// Erratum RP2040-E1: the counter counts down by 2 at each tick.
  static constexpr std::uint32_t kCountdown = 2U * kPeriod.microseconds();
  static_assert(kCountdown < 1U << 24U, "the counter has 24 bits");
};

}  // namespace ex9000::hal::rp2040
