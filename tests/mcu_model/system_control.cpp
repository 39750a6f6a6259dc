#include "tests/mcu_model/system_control.hpp"

namespace ex9000::registers {

namespace {

constexpr unsigned kMainOscillatorOff = 0;
constexpr unsigned kSourceShift = 4;
constexpr unsigned kCrystalShift = 6;
constexpr unsigned kBypass = 11;
constexpr unsigned kPowerDown = 13;
constexpr unsigned kUseDivider = 22;
constexpr unsigned kDividerShift = 23;
constexpr std::uint32_t kLocked = 1U << 6U;

constexpr std::uint32_t source_of(std::uint32_t rcc) { return rcc >> kSourceShift & 0x3U; }

}  // namespace

SystemControl::SystemControl(const Chip& chip, Timeline& timeline)
    : Peripheral(kBase),
      chip_(chip),
      timeline_(timeline),
      rcc_(chip.rcc_at_reset),
      cycle_(chip.cycle_at_reset),
      lock_(timeline, [this] { locked_ = true; }) {}

std::uint32_t SystemControl::read(std::uint32_t offset) {
  if (offset == kRis) {
    return locked_ ? kLocked : 0;
  }
  if (offset == kResc) {
    return causes_;
  }
  if (offset == kRcc) {
    return rcc_;
  }
  if (offset >= kRcgc && offset < kRcgc + 12) {
    return gates_.at((offset - kRcgc) / 4);
  }
  fault(offset, "the model has no such register of system control");
}

void SystemControl::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == kRcc) {
    write_rcc(value);
  } else if (offset == kResc) {
    if ((value & ~causes_) != 0) {
      fault(kResc, "software can clear the causes of a reset, but not set them");
    }
    causes_ = value;
  } else if (offset >= kRcgc && offset < kRcgc + 12) {
    const unsigned index = (offset - kRcgc) / 4;
    for (unsigned bit = 0; bit < 32; ++bit) {
      if ((value & ~gates_.at(index)) >> bit & 1U) {
        opened_.at(index).at(bit) = timeline_.now();
      }
    }
    gates_.at(index) = value;
  } else if (offset >= kSrcr && offset < kSrcr + 12) {
    const unsigned index = (offset - kSrcr) / 4;
    const std::uint32_t begun = value & ~resets_.at(index);
    resets_.at(index) = value;
    for (unsigned bit = 0; bit < 32; ++bit) {
      if ((begun >> bit & 1U) != 0 && on_software_reset_) {
        on_software_reset_(index, bit);
      }
    }
  } else {
    fault(offset, "the model has no writable register of system control here");
  }
}

/// A cause stays until software clears it or the supply is switched off. On the LM3S6965, a reset by the
/// reset pin also clears all other causes.
void SystemControl::was_reset_by(ResetCause cause, std::uint32_t before) {
  const bool clears_others =
      cause == ResetCause::PowerOn || (cause == ResetCause::Pin && chip_.pin_clears_causes);
  causes_ = (clears_others ? 0 : before) | static_cast<std::uint32_t>(cause);
}

SystemControl::Gate SystemControl::gate(unsigned index, unsigned bit) const {
  if ((gates_.at(index) >> bit & 1U) == 0) {
    return Gate::Shut;
  }
  return timeline_.now() < opened_.at(index).at(bit) + chip_.clocks_after_gate * cycle_ ? Gate::TooFresh
                                                                                        : Gate::Open;
}

void SystemControl::write_rcc(std::uint32_t value) {
  const std::uint32_t changed = value ^ rcc_;
  const std::uint32_t crystal = chip_.crystal_field << kCrystalShift;
  if ((changed & chip_.rcc_kept) != 0) {
    fault(kRcc, "the write changes bits of RCC that must keep their value");
  }
  const std::uint32_t validated =
      crystal | (0x3U << kSourceShift) | (1U << kPowerDown) | (0xFU << kDividerShift);
  if ((changed & validated) != 0 && !rcc_has(kBypass)) {
    fault(kRcc, "the write reconfigures the PLL while the processor runs on the PLL");
  }
  if ((changed & validated) != 0 && (changed & ~rcc_ & (1U << kUseDivider)) == 0 && rcc_has(kUseDivider)) {
    fault(kRcc, "the write reconfigures the clock while the divider is in use");
  }
  const bool bypass_ends = rcc_has(kBypass) && (value >> kBypass & 1U) == 0;
  if (bypass_ends && !locked_) {
    fault(kRcc, "the processor would run on a PLL that has not locked");
  }
  if (bypass_ends && (value >> kUseDivider & 1U) == 0) {
    fault(kRcc, "the processor would run on the PLL without a divider");
  }
  if (bypass_ends && (value >> kDividerShift & 0xFU) + 1 < 4) {
    fault(kRcc, "the processor would run at more than 50 MHz");
  }
  const bool powers_up = rcc_has(kPowerDown) && (value >> kPowerDown & 1U) == 0;
  if (rcc_has(kMainOscillatorOff) && (value >> kMainOscillatorOff & 1U) == 0) {
    crystal_swings_ = timeline_.now() + crystal_start_;
  }
  rcc_ = value;
  if (powers_up) {
    if (source_of(rcc_) != 0 || (rcc_ >> kCrystalShift & chip_.crystal_field) != chip_.crystal_code) {
      fault(kRcc, "the PLL is set up for a crystal that the board does not have");
    }
    if (lock_time_ != kNever) {
      lock_.set(std::max(timeline_.now(), crystal_swings_) + lock_time_);
    }
  }
  use_clock();
}

void SystemControl::use_clock() {
  Instant cycle = chip_.cycle_at_reset;
  const bool main_oscillator = source_of(rcc_) == 0;
  if (!rcc_has(kBypass)) {
    cycle = std::chrono::nanoseconds(5) * ((rcc_ >> kDividerShift & 0xFU) + 1);
  } else {
    if (main_oscillator) {
      cycle = chip_.crystal_code == kLm3s6965.crystal_code ? Instant(125'000) : Instant(62'500);
      if (crystal_swings_ == kNever) {
        fault(kRcc, "the processor would run on a crystal that is off");
      }
    }
    if (rcc_has(kUseDivider)) {
      cycle *= (rcc_ >> kDividerShift & 0xFU) + 1;
    }
  }
  if (cycle != cycle_) {
    for (const auto& each : on_clock_change_) {
      each(cycle);
    }
    cycle_ = cycle;
  }
  if (main_oscillator && timeline_.now() < crystal_swings_ && on_standstill_) {
    on_standstill_(crystal_swings_);
  }
}

}  // namespace ex9000::registers
