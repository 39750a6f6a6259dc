// What belongs to the processor: SysTick, the interrupt controller, and who is served when. ARMv7-M
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

  /// What serves an exception.
  void on_exception(std::function<void(unsigned exception)> act) { serve_ = std::move(act); }
  /// The system control block is told to reset the microcontroller.
  void on_reset_request(std::function<void()> act) { on_reset_ = std::move(act); }
  /// An exception has been waiting for this long before it is served, as if instructions that cannot be
  /// interrupted were in its way.
  void set_latency(Instant latency) { latency_ = latency; }

  void interrupt_line_of(unsigned interrupt, bool asserted);
  /// The line is asserted for ever, whatever its peripheral does.
  void stick(unsigned interrupt) {
    stuck_ |= 1U << interrupt;
    interrupt_line_of(interrupt, true);
  }
  void hold(bool on) { held_ = on; }
  [[nodiscard]] bool held() const { return held_; }
  /// Whether a sleeping processor wakes up.
  [[nodiscard]] bool wakes() const { return next_to_serve() != 0; }
  /// When something that is waiting has waited for long enough; kNever: nothing is.
  [[nodiscard]] Instant next_wake() const;
  /// Serves what may be served now, one after the other.
  void serve_pending();
  /// Whether an exception is being served.
  [[nodiscard]] bool in_handler() const { return !active_.empty(); }
  [[nodiscard]] std::size_t deepest_nesting() const { return deepest_; }
  [[nodiscard]] std::uint32_t enabled() const { return enabled_; }
  [[nodiscard]] unsigned priority(unsigned interrupt) const {
    return priority_of(kFirstInterrupt + interrupt);
  }
  /// Of a priority the part by which one interrupt interrupts another.
  [[nodiscard]] unsigned group(unsigned priority) const { return priority >> (group_shift_ + 1U); }
  [[nodiscard]] std::uint32_t tick_reload() const { return reload_; }
  /// When the tick last came, served or not.
  [[nodiscard]] Instant ticked() const { return tick_began_; }

 private:
  [[nodiscard]] std::uint32_t current() const;
  [[nodiscard]] unsigned priority_of(unsigned exception) const;
  [[nodiscard]] unsigned next_to_serve() const;
  /// Those that are pending and enabled.
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
  Instant tick_began_{0};  ///< when the counter last was at zero
  Alarm tick_;

  std::uint32_t enabled_ = 0;
  std::array<std::uint8_t, 32> priorities_{};
  unsigned group_shift_ = 0;
  std::array<bool, 32> lines_{};
  std::uint32_t stuck_ = 0;    ///< of the lines
  std::uint64_t pending_ = 0;  ///< a bit an exception
  std::array<Instant, kExceptions> since_{};
  std::vector<unsigned> active_;
  std::size_t deepest_ = 0;
  bool held_ = false;
};

}  // namespace ex9000::registers
