// Clock tree, clock gates and the reason of a reset. Sources: LM3S6965 data sheet, 5.3 and 5.5 (system
// control); TM4C123GH6PM data sheet, 5.3, 5.5 and 5.6. RCC and the legacy RCGCn registers of the TM4C are the
// same, also in the bits used here, unless a comment says otherwise.
#pragma once

#include <cstdint>

#include "firmware/reset_reason.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::stellaris {

/// A crystal on the main oscillator, the PLL's 400 MHz divided by 2, and a divider.
struct ClockTree {
  std::uint32_t crystal_code;  ///< RCC field XTAL
  std::uint32_t divider;       ///< divides 200 MHz; 4 to 16

  [[nodiscard]] constexpr std::uint32_t frequency() const { return 200'000'000U / divider; }  // in Hz
};

/// The peripherals that need a clock, one bit each.
struct ClockGates {
  std::uint32_t rcgc0;
  std::uint32_t rcgc1;
  std::uint32_t rcgc2;
};

namespace clock_gate {
constexpr std::uint32_t kWatchdog = 1U << 3U;  // RCGC0
constexpr std::uint32_t kUart0 = 1U << 0U;     // RCGC1, like the bits below
constexpr std::uint32_t kUart1 = 1U << 1U;
constexpr std::uint32_t kI2c0 = 1U << 12U;
constexpr std::uint32_t kTimer0 = 1U << 16U;
constexpr std::uint32_t kTimer1 = 1U << 17U;
constexpr std::uint32_t kTimer2 = 1U << 18U;
}  // namespace clock_gate

class SystemControl {
 public:
  /// Once after reset, when the watchdog is running. Blocks until the crystal has started, some milliseconds,
  /// and the PLL has locked, some hundred microseconds more. If the PLL never locks, the watchdog resets the
  /// MCU. If the crystal never starts, processor and watchdog have no clock, and the outputs stay off.
  static void use(const ClockTree& clock) {
    constexpr Bits<Rcc> kBypass(1U << 11U);
    constexpr Bits<Rcc> kPowerDown(1U << 13U);
    constexpr Bits<Rcc> kOutputDisable(1U << 12U);  // LM3S only; reserved on the TM4C
    constexpr Bits<Rcc> kUseDivider(1U << 22U);
    constexpr Bits<Rcc> kDivider(0xFU << 23U);
    constexpr Bits<Rcc> kCrystal(0x1FU << 6U);          // bit 10 is reserved on the LM3S
    constexpr Bits<Rcc> kOscillatorSource(0x3U << 4U);  // 0: the main oscillator
    constexpr Bits<Rcc> kMainOscillatorOff(1U << 0U);
    constexpr Bits<InterruptStatus> kPllLocked(1U << 6U);

    // Both data sheets require a bypass of the PLL while it is configured.
    Bits<Rcc> rcc = (kRcc.read() | kBypass).without(kUseDivider);
    kRcc.write(rcc);
    rcc = rcc.without(kCrystal | kOscillatorSource | kMainOscillatorOff | kPowerDown | kOutputDisable) |
          Bits<Rcc>(clock.crystal_code << 6U);
    kRcc.write(rcc);
    rcc = rcc.without(kDivider) | Bits<Rcc>((clock.divider - 1U) << 23U) | kUseDivider;
    kRcc.write(rcc);
    while (!kRawInterruptStatus.read().has(kPllLocked)) {
    }
    kRcc.write(rcc.without(kBypass));
  }

  /// Waits until the registers of the peripherals can be accessed.
  static void open(const ClockGates& gates) {
    kRcgc0.set(Bits<Rcgc0>(gates.rcgc0));
    kRcgc1.write(Bits<Rcgc1>(gates.rcgc1));  // after reset, these clocks are off
    kRcgc2.write(Bits<Rcgc2>(gates.rcgc2));
    // No access for 3 clocks (LM3S) or 5 (TM4C) after a clock is enabled; each read takes at least 2.
    for (int i = 0; i < 3; ++i) {
      (void)kRcgc2.read();
    }
  }

  /// Of the last reset. Once after each, as early as possible: most resets do not clear RESC (data sheets,
  /// "Reset Cause"), so after another reset before this call it may have the bits of both. This clears it.
  static ResetReason take_reset_reason() {
    constexpr Bits<ResetCause> kPin(1U << 0U);
    constexpr Bits<ResetCause> kPowerOn(1U << 1U);
    constexpr Bits<ResetCause> kBrownOut(1U << 2U);
    constexpr Bits<ResetCause> kWatchdog(1U << 3U);
    constexpr Bits<ResetCause> kSoftware(1U << 4U);
    const Bits<ResetCause> causes = kResetCause.read();
    kResetCause.write({});
    // The supply first, because the pin may be low for longer than the power-on reset. An image requests a
    // software reset only after a fault or an unexpected interrupt.
    return causes.has(kPowerOn | kBrownOut) ? ResetReason::PowerOn
           : causes.has(kPin)               ? ResetReason::ResetPin
           : causes.has(kWatchdog)          ? ResetReason::ModuleWatchdog
           : causes.has(kSoftware)          ? ResetReason::Fault
                                            : ResetReason::Unknown;
  }

 private:
  struct Rcc;
  struct ResetCause;
  struct InterruptStatus;
  struct Rcgc0;
  struct Rcgc1;
  struct Rcgc2;
  static constexpr Register<InterruptStatus> kRawInterruptStatus{0x400F'E050};
  static constexpr Register<ResetCause> kResetCause{0x400F'E05C};
  static constexpr Register<Rcc> kRcc{0x400F'E060};
  static constexpr Register<Rcgc0> kRcgc0{0x400F'E100};
  static constexpr Register<Rcgc1> kRcgc1{0x400F'E104};
  static constexpr Register<Rcgc2> kRcgc2{0x400F'E108};
};

}  // namespace ex9000::hal::stellaris
