// The system PLL and the clock tree. Source: RP2040 data sheet, 2.15 (clocks) and 2.18 (PLL).
#pragma once

#include <cstdint>

#include "hal/rp2040/crystal.hpp"
#include "hal/rp2040/resets.hpp"
#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// A crystal, whose frequency the PLL multiplies and then divides by two values.
struct ClockTree {
  std::uint32_t crystal;     ///< Hz, a whole number of MHz, 5 MHz to 15 MHz
  std::uint32_t multiplier;  ///< 16 to 320
  std::uint32_t divider_1;   ///< 1 to 7, not less than `divider_2`
  std::uint32_t divider_2;   ///< 1 to 7

  [[nodiscard]] constexpr std::uint32_t oscillator() const { return crystal * multiplier; }
  /// Of the processor and the peripherals, in Hz.
  [[nodiscard]] constexpr std::uint32_t frequency() const { return oscillator() / divider_1 / divider_2; }
};

class Clocks {
 public:
  /// Boot::copy requires a slower clock than the PLL, on which processor and flash interface still run after
  /// a reset of only the processor, for example by a debug probe. Inlined for the second stage; see Boot.
  [[gnu::always_inline]] static void use_reference() {
    kSystemControl.clear(kFromPll);
    while (!kSystemSelected.read().has(kReferenceSelected)) {
    }
  }

  /// The crystal, which the second stage has started, feeds the reference clock; the PLL feeds processor and
  /// peripherals. Once after reset, when the watchdog is running: it resets the MCU if the crystal never
  /// becomes stable or the PLL never locks. Blocks less than 1 ms if the crystal is stable.
  template <const ClockTree& clock>
  static void use() {
    static_assert(clock.oscillator() >= 750'000'000 && clock.oscillator() <= 1'600'000'000,
                  "clock: the frequency of the PLL's oscillator must be 750 MHz to 1600 MHz");
    static_assert(clock.frequency() <= 133'000'000,
                  "clock: the frequency of the processor must be at most 133 MHz");
    while (!Crystal::stable()) {
    }
    Crystal::make_reference();
    while (!Crystal::is_reference()) {
    }
    start_pll(clock);
    kSystemControl.write(kFromPll);  // after a reset, the auxiliary source is the system PLL
    while (!kSystemSelected.read().has(kAuxiliarySelected)) {
    }
    kPeripheralControl.write(kPeripheralEnable);  // the source of this clock is the system clock
  }

 private:
  struct PllControl;
  struct PllPower;
  struct PllFeedback;
  struct PllDividers;
  struct SystemControl;
  struct SystemSelected;
  struct PeripheralControl;

  static constexpr SharedRegister<PllControl> kPllControl{0x4002'8000};
  static constexpr SharedRegister<PllPower> kPllPower{0x4002'8004};
  static constexpr SharedRegister<PllFeedback> kPllFeedback{0x4002'8008};
  static constexpr SharedRegister<PllDividers> kPllDividers{0x4002'800C};
  static constexpr SharedRegister<SystemControl> kSystemControl{0x4000'803C};
  static constexpr SharedRegister<SystemSelected> kSystemSelected{0x4000'8044};
  static constexpr SharedRegister<PeripheralControl> kPeripheralControl{0x4000'8048};

  static constexpr Bits<SystemControl> kFromPll{0x1};
  static constexpr Bits<SystemSelected> kReferenceSelected{1U << 0U};
  static constexpr Bits<SystemSelected> kAuxiliarySelected{1U << 1U};
  static constexpr Bits<PeripheralControl> kPeripheralEnable{1U << 11U};

  static void start_pll(const ClockTree& clock) {
    constexpr Bits<PllControl> kReferenceDividedBy1(1);
    constexpr Bits<PllControl> kLocked(1U << 31U);
    constexpr Bits<PllPower> kMainOff(1U << 0U);
    constexpr Bits<PllPower> kDividersOff(1U << 3U);
    constexpr Bits<PllPower> kOscillatorOff(1U << 5U);
    Resets::restart(static_cast<std::uint32_t>(Block::SystemPll));
    kPllControl.write(kReferenceDividedBy1);
    kPllFeedback.write(Bits<PllFeedback>(clock.multiplier));
    kPllPower.clear(kMainOff | kOscillatorOff);
    while (!kPllControl.read().has(kLocked)) {
    }
    kPllDividers.write(Bits<PllDividers>(clock.divider_1 << 16U | clock.divider_2 << 12U));
    kPllPower.clear(kDividersOff);
  }
};

}  // namespace ex9000::hal::rp2040
