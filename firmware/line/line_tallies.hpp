// The counts of interrupts for Modbus function 08 (Modbus over Serial Line V1.02, appendix A) and for
// registers 0x0308 to 0x030F (firmware/extensions.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/line/verdict.hpp"

namespace ex9000 {

/// Damaged bytes, and frames by verdict: the end of a frame increments at most one count, and the main loop
/// adds up verdicts. 32 bits take the interrupt less time than the 16 bits of an EventTally.
class LineTallies {
 public:
  [[gnu::always_inline]] void count_in_interrupt(Verdict verdict, std::uint32_t frames = 1) {
    auto& total = totals_[static_cast<std::size_t>(verdict)];
    total.store_in_interrupt(total.load() + frames);
  }

  /// A byte with a framing or parity error, or a break.
  [[gnu::always_inline]] void count_damaged_byte_in_interrupt() {
    damaged_bytes_.store_in_interrupt(damaged_bytes_.load() + 1U);
  }

  /// Frames with a verdict from `first` to `last` since reset or `clear`, modulo 65536. For the main loop.
  [[nodiscard, gnu::noinline]] std::uint16_t count(Verdict first, Verdict last) const {
    unsigned sum = 0;
    for (auto each = static_cast<std::size_t>(first); each <= static_cast<std::size_t>(last); ++each) {
      sum += totals_[each].load() - cleared_[each];
    }
    return static_cast<std::uint16_t>(sum);
  }
  [[nodiscard]] unsigned bus_messages() const { return count(Verdict::Accepted, Verdict::NoRoom); }
  [[nodiscard]] unsigned bus_errors() const { return count(Verdict::BadCheck, Verdict::Overrun); }
  [[nodiscard]] unsigned server_messages() const { return count(Verdict::Accepted, Verdict::Ignored); }
  [[nodiscard]] unsigned no_responses() const { return count(Verdict::HostOk, Verdict::Ignored); }
  [[nodiscard]] unsigned lost_frames() const { return count(Verdict::NoRoom, Verdict::NoRoom); }
  [[nodiscard]] unsigned damaged_bytes() const { return damaged_bytes_.load() - damaged_bytes_cleared_; }
  [[nodiscard]] unsigned overruns() const {
    return lost_frames() + count(Verdict::Overrun, Verdict::Overrun);
  }

  void clear() {
    for (std::size_t each = 0; each < kVerdicts; ++each) {
      cleared_[each] = static_cast<std::uint16_t>(totals_[each].load());
    }
    damaged_bytes_cleared_ = damaged_bytes_.load();
  }

 private:
  static constexpr std::size_t kVerdicts = static_cast<std::size_t>(Verdict::Overrun) + 1;

  std::array<WrittenByInterrupt<std::uint32_t>, kVerdicts> totals_;
  std::array<std::uint16_t, kVerdicts> cleared_{};  // for the main loop only
  WrittenByInterrupt<std::uint32_t> damaged_bytes_;
  std::uint32_t damaged_bytes_cleared_ = 0;  // for the main loop only
};

}  // namespace ex9000
