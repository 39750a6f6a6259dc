// The crystal oscillator and the reference clock. Source: RP2040 data sheet, 2.15 and 2.16.
#pragma once

#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// All is inlined, for the second stage of the boot sequence: the image is not in RAM yet. Nothing blocks.
class Crystal {
 public:
  /// If it is not running. `stable` 50,176 periods later, as a power-on reset sets it: 4.2 ms at 12 MHz.
  [[gnu::always_inline]] static void start() {
    constexpr Bits<Control> kRange(0xAA0);
    constexpr Bits<Control> kEnable(0xFABU << 12U);
    kControl.write(kRange | kEnable);
  }
  [[nodiscard, gnu::always_inline]] static bool stable() {
    constexpr Bits<Status> kStable(1U << 31U);
    return kStatus.read().has(kStable);
  }

  /// As source of the reference clock, in place of the ring oscillator. Only while `stable`. Processor and
  /// flash interface run on it until `Clocks::use` switches them to the PLL.
  [[gnu::always_inline]] static void make_reference() {
    constexpr Bits<ReferenceControl> kFromCrystal(0x2);
    kReferenceControl.write(kFromCrystal);
  }
  [[nodiscard, gnu::always_inline]] static bool is_reference() {
    constexpr Bits<ReferenceSelected> kCrystalSelected(1U << 2U);
    return kReferenceSelected.read().has(kCrystalSelected);
  }

 private:
  struct Control;
  struct Status;
  struct ReferenceControl;
  struct ReferenceSelected;
  static constexpr SharedRegister<Control> kControl{0x4002'4000};
  static constexpr SharedRegister<Status> kStatus{0x4002'4004};
  static constexpr SharedRegister<ReferenceControl> kReferenceControl{0x4000'8030};
  static constexpr SharedRegister<ReferenceSelected> kReferenceSelected{0x4000'8038};
};

}  // namespace ex9000::hal::rp2040
