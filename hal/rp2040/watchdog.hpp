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
  /// All but the oscillators. For interrupts, faults and the main loop.
  [[noreturn]] static void reset_chip() {
    kResetBy.write(kAllButOscillators);
    kControl.set(kTrigger);
    for (;;) {
    }
  }

  /// Of the last reset. Before `start`.
  [[nodiscard]] static ResetReason reset_reason() {
    constexpr Bits<Reason> kTimeout(1U << 0U);
    constexpr Bits<Reason> kRequest(1U << 1U);
    constexpr Bits<ChipReset> kSupply(1U << 8U);
    constexpr Bits<ChipReset> kRunPin(1U << 16U);
    const Bits<Reason> reason = kReason.read();
    if (reason.has(kRequest | kTimeout)) {
      // Only images write the mark: the boot ROM, too, resets the chip with the watchdog, after it has copied
      // an image to the flash. With the mark, only `fault_handler` requests a reset.
      return kMark.read().value() != kOfAnImage.value() ? ResetReason::Software
             : reason.has(kRequest)                     ? ResetReason::Fault
                                                        : ResetReason::ModuleWatchdog;
    }
    // Not after a reset by the watchdog, which does not change the bits of the last chip-level reset.
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
  /// The first of eight scratch registers. A chip-level reset clears it, one by the watchdog does not. The
  /// boot sequence (2.8.1) uses only the last four.
  static constexpr SharedRegister<Mark> kMark{0x4005'800C};
  static constexpr SharedRegister<Tick> kTick{0x4005'802C};
  static constexpr SharedRegister<ResetBy> kResetBy{0x4001'0008};
  static constexpr SharedRegister<ChipReset> kChipReset{0x4006'4008};
  static constexpr Bits<Control> kEnable{1U << 30U};
  static constexpr Bits<Control> kTrigger{1U << 31U};
  static constexpr Bits<Tick> kTickEnable{1U << 9U};
  static constexpr Bits<Mark> kOfAnImage{0x4558'9000};  ///< any value that other software does not write
  /// Without these, a reset by the watchdog leaves the peripherals as they are. The oscillators need none.
  static constexpr Bits<ResetBy> kAllButOscillators{0x1'FFFC};
};

/// `reference`: the reference clock in MHz while the crystal is its source.
template <std::uint32_t reference>
class HardwareWatchdog : public WatchdogRegisters {
 public:
  /// Starts the tick for the watchdog and the timer, then the watchdog, until the next reset. On the ring
  /// oscillator instead of a crystal of 12 MHz, ticks and countdown can take up to twelve times as long.
  static void start() {
    kMark.write(kOfAnImage);
    start_countdown();
  }

  /// For the loader: `start` without effect on what `reset_reason` returns in the image.
  static void start_countdown() {
    kTick.write(Bits<Tick>(reference) | kTickEnable);
    kControl.clear(kEnable);
    kResetBy.write(kAllButOscillators);
    feed();
    kControl.set(kEnable);
  }

  static void feed() { kLoad.write(Bits<Load>(kCountdown)); }

  /// Resets the MCU; the reason is then Software.
  [[noreturn]] static void restart() {
    kMark.write({});
    reset_chip();
  }

 private:
  static constexpr Duration kPeriod = milliseconds(1500);
  static_assert(kPeriod.microseconds() < kWatchdogPeriod.microseconds(), "the period is too long");
  /// Erratum RP2040-E1: each tick counts down by 2.
  static constexpr std::uint32_t kCountdown = 2U * kPeriod.microseconds();
  static_assert(kCountdown < 1U << 24U, "the counter has 24 bits");
};

}  // namespace ex9000::hal::rp2040
