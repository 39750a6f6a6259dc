// Resets in a row by the module watchdog or a fault - wire.md section 2.
#pragma once

#include <cstdint>

#include "firmware/reset_reason.hpp"

namespace ex9000 {

/// In seconds, without a reset: firmware that lives so long works. It is in no crash loop, and a new image
/// that has replied is confirmed (extensions.md, firmware update).
constexpr std::uint32_t kProof = 60;

/// The board keeps `to_keep` through such resets (hal/kept_word.hpp). After a few, the module starts with the
/// safe value, so that a crash loop does not click relays.
class CrashCount {
 public:
  /// At a reset. `kept`: the last `to_keep` before it; any number after a reset for another reason, or if the
  /// board has lost it.
  void begin(ResetReason reason, std::uint32_t kept) {
    const bool crash = reason == ResetReason::ModuleWatchdog || reason == ResetReason::Fault;
    const std::uint32_t before = kept - kMark <= kLoop ? kept - kMark : 0;
    count_ = !crash ? 0 : before < kLoop ? before + 1 : kLoop;
    looping_ = count_ == kLoop;
  }
  /// This reset was at least the third one.
  [[nodiscard]] bool looping() const { return looping_; }
  [[nodiscard]] std::uint32_t to_keep() const { return kMark + count_; }
  /// `seconds`: since the reset.
  void lived(std::uint32_t seconds) {
    if (seconds >= kProof) {
      count_ = 0;
    }
  }

 private:
  static constexpr std::uint32_t kLoop = 3;
  static constexpr std::uint32_t kMark = 0x4372'6100;  ///< any value that is not there by chance

  std::uint32_t count_ = 0;
  bool looping_ = false;
};

}  // namespace ex9000
