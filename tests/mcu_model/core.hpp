// The processor: SysTick, the interrupt controller, and the order in which exceptions are served. ARMv7-M
// Architecture Reference Manual: B1.5 (exceptions), B3.2 (system control block), B3.3 (SysTick), B3.4 (NVIC).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/mcu_model/peripheral.hpp"
#include "tests/mcu_model/system_control.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class Core final : public Peripheral {
 public:
  static constexpr std::uint32_t kBase = 0xE000'E000;
  static constexpr std::uint32_t kTickControl = 0x010;
  static constexpr std::uint32_t kTickReload = 0x014;
  static constexpr std::uint32_t kTickCurrent = 0x018;
  static constexpr std::uint32_t kSetEnable = 0x100;
  static constexpr std::uint32_t kPriority = 0x400;
  static constexpr std::uint32_t kInterruptControl = 0xD04;
  static constexpr std::uint32_t kApplicationInterrupt = 0xD0C;

  /// Exception numbers: interrupt n is kFirstInterrupt + n.
  static constexpr unsigned kTick = 15;
  static constexpr unsigned kFirstInterrupt = 16;
  static constexpr unsigned kExceptions = kFirstInterrupt + 32;

  Core(const SystemControl& clock, Timeline& timeline);

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;

  /// Sets the function that serves each exception.
  void on_exception(std::function<void(unsigned exception)> act) { serve_ = std::move(act); }
  /// Sets the function to call when software requests a reset through the system control block.
  void on_reset_request(std::function<void()> act) { on_reset_ = std::move(act); }
  /// Sets the minimum time between the moment when an exception becomes pending and the call of its handler.
  /// On a chip, an instruction that cannot be interrupted causes such a delay.
  void set_latency(Instant latency) { latency_ = latency; }

  void interrupt_line_of(unsigned interrupt, bool asserted);
  /// Asserts the interrupt line permanently, independently of its peripheral.
  void stick(unsigned interrupt) {
    stuck_ |= 1U << interrupt;
    interrupt_line_of(interrupt, true);
  }
  /// Loses an interrupt from now on, as if the line between its peripheral and the processor were broken.
  void lose(unsigned interrupt) { lost_ |= 1U << interrupt; }
  void hold(bool on) { held_ = on; }
  [[nodiscard]] bool held() const { return held_; }
  /// Returns whether a sleeping processor wakes up now.
  [[nodiscard]] bool wakes() const { return next_to_serve() != 0; }
  /// Returns the earliest time at which the latency of an enabled pending exception ends; kNever if there is
  /// none.
  [[nodiscard]] Instant next_wake() const;
  /// Serves all exceptions that may be served now, one after the other.
  void serve_pending();
  [[nodiscard]] bool in_handler() const { return !active_.empty(); }
  [[nodiscard]] std::size_t deepest_nesting() const { return deepest_; }
  [[nodiscard]] std::uint32_t enabled() const { return enabled_; }
  [[nodiscard]] unsigned priority(unsigned interrupt) const {
    return priority_of(kFirstInterrupt + interrupt);
  }
  /// Returns the group priority: the part of a priority that decides whether one interrupt preempts another.
  [[nodiscard]] unsigned group(unsigned priority) const { return priority >> (group_shift_ + 1U); }
  [[nodiscard]] std::uint32_t tick_reload() const { return reload_; }
  /// Returns the time of the last tick, served or not. Returns the time at which the counter was enabled, if
  /// no tick has followed.
  [[nodiscard]] Instant ticked() const { return tick_began_; }

 private:
  [[nodiscard]] std::uint32_t current() const;
  [[nodiscard]] unsigned priority_of(unsigned exception) const;
  [[nodiscard]] unsigned next_to_serve() const;
  /// Returns the exceptions that are pending and enabled.
  [[nodiscard]] std::uint64_t waiting() const {
    return pending_ & (1ULL << kTick | std::uint64_t{enabled_} << kFirstInterrupt);
  }
  void pend(unsigned exception);
  void count_tick();

  const SystemControl& clock_;
  Timeline& timeline_;
  std::function<void(unsigned)> serve_;
  std::function<void()> on_reset_;
  Instant latency_{0};

  std::uint32_t tick_control_ = 0;
  std::uint32_t reload_ = 0;
  Instant tick_began_{0};  ///< when the counter was last at zero, or was enabled
  Alarm tick_;

  std::uint32_t enabled_ = 0;
  std::array<std::uint8_t, 32> priorities_{};
  unsigned group_shift_ = 0;
  std::array<bool, 32> lines_{};
  std::uint32_t stuck_ = 0;    ///< a bit for each line
  std::uint32_t lost_ = 0;     ///< a bit for each line
  std::uint64_t pending_ = 0;  ///< a bit for each exception
  std::array<Instant, kExceptions> since_{};
  std::vector<unsigned> active_;
  std::size_t deepest_ = 0;
  bool held_ = false;
};

}  // namespace ex9000::registers
