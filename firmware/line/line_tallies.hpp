// What the receive interrupt counts for Modbus function 08 (Modbus over Serial Line V1.02, appendix A).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/line/crossing.hpp"
#include "firmware/line/verdict.hpp"

namespace ex9000 {

/// Frames by what became of them: one count each, so that the interrupt has one to look after. Which of them
/// make up a counter is for those who are asked for it. Whole words, which cost the interrupt less than an
/// EventTally's halves.
class LineTallies {
 public:
  /// Interrupt.
  [[gnu::always_inline]] void count_in_interrupt(Verdict verdict) {
    auto& total = totals_[static_cast<std::size_t>(verdict)];
    total.store_in_interrupt(total.load() + 1U);
  }

  /// Main loop: since reset or `clear`, modulo 65536; of the verdicts from `first` to `last`.
  [[nodiscard, gnu::noinline]] std::uint16_t count(Verdict first, Verdict last) const {
    unsigned sum = 0;
    for (auto each = static_cast<std::size_t>(first); each <= static_cast<std::size_t>(last); ++each) {
      sum += totals_[each].load() - cleared_[each];
    }
    return static_cast<std::uint16_t>(sum);
  }
  [[nodiscard]] unsigned bus_messages() const { return count(Verdict::Accepted, Verdict::NoRoom); }
  [[nodiscard]] unsigned bus_errors() const { return count(Verdict::BadCheck, Verdict::Overrun); }
  [[nodiscard]] unsigned server_messages() const { return count(Verdict::Accepted, Verdict::HostOk); }
  [[nodiscard]] unsigned no_responses() const { return count(Verdict::HostOk, Verdict::HostOk); }
  [[nodiscard]] unsigned overruns() const {
    return count(Verdict::NoRoom, Verdict::NoRoom) + count(Verdict::Overrun, Verdict::Overrun);
  }

  /// Main loop.
  void clear() {
    for (std::size_t each = 0; each < kVerdicts; ++each) {
      cleared_[each] = static_cast<std::uint16_t>(totals_[each].load());
    }
  }

 private:
  static constexpr std::size_t kVerdicts = static_cast<std::size_t>(Verdict::Overrun) + 1;

  std::array<WrittenByInterrupt<std::uint32_t>, kVerdicts> totals_;
  std::array<std::uint16_t, kVerdicts> cleared_{};  // main loop
};

}  // namespace ex9000
