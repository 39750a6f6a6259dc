// The outcome of a request: a refusal, or what the module must do before it sends the reply.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/request/refusal.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/update/request.hpp"

namespace ex9000 {

/// Each bit that is set in `mask` gets its value in `value`.
struct BitWrite {
  std::uint16_t mask = 0;
  std::uint16_t value = 0;

  [[nodiscard]] constexpr std::uint16_t applied_to(std::uint16_t bits) const {
    return static_cast<std::uint16_t>((bits & ~mask) | (value & mask));
  }
};

/// Each channel in `mask` is switched on for `units` x 0.1 s, or off if that is 0.
struct TimedDrive {
  std::uint16_t mask = 0;
  std::array<std::uint16_t, kMaxOutputs> units{};
};

/// Neither changes settings nor drives outputs. Carried out last.
enum class Effect : std::uint8_t {
  RestartHostWatchdog,
  TakeAddress,       ///< use the stored address from now on
  TakeCountingEdge,  ///< from now on, count the edges that the stored format selects
  TakeSample,
  MarkSampleRead,
  ClearResetStatus,
  ClearLatches,
  ClearDiagnostics,
  ClearCounters,
  ClearTimeoutCount,
};

/// The module first stores a change of settings, then does the rest, and judges no other frame in between. In
/// masks, bit n is channel n; 0 means none.
class Outcome {
 public:
  void request(Effect effect) { effects_ = static_cast<std::uint16_t>(effects_ | bit(effect)); }
  [[nodiscard]] bool asks_for(Effect effect) const { return (effects_ & bit(effect)) != 0; }
  [[nodiscard]] bool has_effects() const { return effects_ != 0; }

  void ask_update(const update::Request& request) { update_ = request; }
  [[nodiscard]] const update::Request& asked_of_update() const { return update_; }

  void drive(BitWrite outputs) { drive_ = outputs; }
  [[nodiscard]] BitWrite outputs_to_drive() const { return drive_; }

  void drive_for(unsigned channel, std::uint16_t units) {
    timed_drive_.mask = static_cast<std::uint16_t>(timed_drive_.mask | 1U << channel);
    timed_drive_.units[channel] = units;
  }
  [[nodiscard]] const TimedDrive& timed_outputs_to_drive() const { return timed_drive_; }
  [[nodiscard]] bool drives_outputs() const { return (drive_.mask | timed_drive_.mask) != 0; }

  /// Now the request changes settings; the caller adds them to the result.
  SettingsChange& change() {
    changes_settings_ = true;
    return change_;
  }
  [[nodiscard]] const SettingsChange& change() const { return change_; }
  [[nodiscard]] bool changes_settings() const { return changes_settings_; }

  /// Removes all actions, but keeps the refusal.
  void clear() {
    effects_ = 0;
    drive_ = {};
    timed_drive_.mask = 0;
    counters_to_clear = 0;
    update_.ask = update::Ask::Nothing;
    if (changes_settings_) {
      changes_settings_ = false;
      change_ = SettingsChange();
    }
  }

  Refusal refusal = Refusal::None;
  std::uint16_t counters_to_clear = 0;  ///< bit n: counter n; for Effect::ClearCounters

 private:
  static constexpr unsigned bit(Effect effect) { return 1U << static_cast<unsigned>(effect); }

  std::uint16_t effects_ = 0;
  bool changes_settings_ = false;
  update::Request update_;
  BitWrite drive_;
  TimedDrive timed_drive_;
  SettingsChange change_;
};

}  // namespace ex9000
