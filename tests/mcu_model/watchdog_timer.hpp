// Watchdog timer 0. Data sheets: LM3S6965 10.3 to 10.5, TM4C123GH6PM 12.3 to 12.5.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "tests/mcu_model/peripheral.hpp"
#include "tests/mcu_model/system_control.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class WatchdogTimer final : public Peripheral {
 public:
  static constexpr std::uint32_t kBase = 0x4000'0000;
  static constexpr std::uint32_t kLoad = 0x000;
  static constexpr std::uint32_t kControl = 0x008;
  static constexpr std::uint32_t kClear = 0x00C;
  static constexpr std::uint32_t kLock = 0xC00;

  /// If the reset output is enabled, the timer calls `on_expiry` at the end of the second countdown after the
  /// start or the last feed.
  WatchdogTimer(SystemControl& clock, Timeline& timeline, std::function<void()> on_expiry)
      : Peripheral(kBase),
        clock_(clock),
        timeline_(timeline),
        on_expiry_(std::move(on_expiry)),
        end_(timeline, [this] { counted_down(); }) {
    clock.on_clock_change([this](Instant cycle) { change_clock(cycle); });
  }

  std::uint32_t read(std::uint32_t offset) override {
    fault(offset, "the model has no such register of the watchdog");
  }

  void write(std::uint32_t offset, std::uint32_t value) override {
    if (offset == kLock) {
      locked_ = value != kKey;
      return;
    }
    if (locked_) {
      fault(offset, "the watchdog is locked");
    }
    switch (offset) {
      case kLoad:
        load_ = value;
        begin();
        break;
      case kControl:
        if ((control_ & ~value & 1U) != 0) {
          fault(offset, "after the watchdog has started, only a reset stops it");
        }
        control_ = value;
        begin();
        break;
      case kClear:
        flagged_ = false;
        ++feeds_;
        begin();
        break;
      default:
        fault(offset, "the model has no writable register of the watchdog here");
    }
  }

  [[nodiscard]] bool locked() const { return locked_; }
  [[nodiscard]] bool running() const { return end_.is_set(); }
  [[nodiscard]] unsigned feeds() const { return feeds_; }
  /// Returns whether the first countdown after the start or the last feed has ended.
  [[nodiscard]] bool flagged() const { return flagged_; }

 private:
  static constexpr std::uint32_t kKey = 0x1ACC'E551;

  void begin() {
    if ((control_ & 1U) != 0) {
      end_.set(timeline_.now() + load_ * clock_.cycle());
    }
  }
  void counted_down() {
    if (flagged_ && (control_ & 2U) != 0) {
      on_expiry_();
      return;
    }
    flagged_ = true;
    begin();
  }
  void change_clock(Instant cycle) {
    if (end_.is_set()) {
      end_.set(timeline_.now() + (end_.when() - timeline_.now()) / clock_.cycle() * cycle);
    }
  }

  SystemControl& clock_;
  Timeline& timeline_;
  std::function<void()> on_expiry_;
  std::uint32_t load_ = 0xFFFF'FFFF;
  std::uint32_t control_ = 0;
  bool locked_ = false;
  bool flagged_ = false;
  unsigned feeds_ = 0;
  Alarm end_;
};

}  // namespace ex9000::registers
