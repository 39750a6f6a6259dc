// A general-purpose timer in 32-bit one-shot mode. Data sheets: LM3S6965 9.3 to 9.5, TM4C123GH6PM 11.3 to
// 11.5.
#pragma once

#include <cstdint>

#include "tests/mcu_model/peripheral.hpp"
#include "tests/mcu_model/system_control.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class TimerBlock final : public Peripheral {
 public:
  static constexpr std::uint32_t kConfiguration = 0x000;
  static constexpr std::uint32_t kMode = 0x004;
  static constexpr std::uint32_t kControl = 0x00C;
  static constexpr std::uint32_t kMask = 0x018;
  static constexpr std::uint32_t kRaw = 0x01C;
  static constexpr std::uint32_t kMasked = 0x020;
  static constexpr std::uint32_t kClear = 0x024;
  static constexpr std::uint32_t kInterval = 0x028;

  TimerBlock(unsigned number, const SystemControl& clock, Timeline& timeline)
      : Peripheral(0x4003'0000U + number * 0x1000U),
        clock_(clock),
        timeline_(timeline),
        end_(timeline, [this] {
          control_ &= ~1U;
          raw_ |= 1U;
          tell_interrupt();
        }) {}

  std::uint32_t read(std::uint32_t offset) override {
    switch (offset) {
      case kMasked:
        return raw_ & mask_;
      default:
        fault(offset, "the model has no such register of a timer");
    }
  }

  void write(std::uint32_t offset, std::uint32_t value) override {
    const bool running = (control_ & 1U) != 0;
    switch (offset) {
      case kConfiguration:
      case kMode:
        if (running) {
          fault(offset, "the configuration or the mode is written while the timer is enabled");
        }
        (offset == kMode ? mode_ : configuration_) = value;
        break;
      case kControl:
        control(value);
        break;
      case kMask:
        mask_ = value;
        tell_interrupt();
        break;
      case kClear:
        raw_ &= ~value;
        tell_interrupt();
        break;
      case kInterval:
        if (running) {
          fault(offset, "the interval is written while the timer counts");
        }
        interval_ = value;
        break;
      default:
        fault(offset, "the model has no writable register of a timer here");
    }
  }

 private:
  void control(std::uint32_t value) {
    const bool was_running = (control_ & 1U) != 0;
    control_ = value;
    if ((value & 1U) == 0) {
      end_.cancel();
    } else if (!was_running) {
      if (configuration_ != 0 || mode_ != 1) {
        fault(kControl, "the simulation supports only the 32-bit one-shot mode that counts down");
      }
      end_.set(timeline_.now() + interval_ * clock_.cycle());
    }
  }
  void tell_interrupt() { interrupt_line((raw_ & mask_) != 0); }

  const SystemControl& clock_;
  Timeline& timeline_;
  std::uint32_t configuration_ = 0;
  std::uint32_t mode_ = 0;
  std::uint32_t control_ = 0;
  std::uint32_t mask_ = 0;
  std::uint32_t raw_ = 0;
  std::uint32_t interval_ = 0xFFFF'FFFF;
  Alarm end_;
};

}  // namespace ex9000::registers
