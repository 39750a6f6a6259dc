// The outcome of a request: a refusal, or what the module must do before it sends the reply.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// Why a request is refused. The module carries out no action of it.
enum class Refusal : std::uint8_t {
  None,
  // ASCII: the reply is `?AA` or `?` (wire.md section 3)
  UnknownCommand,  ///< no command of this model has this syntax
  OutOfRange,      ///< an argument has a wrong form, is out of range, or contradicts a stored setting
  NotPermitted,    ///< the configuration permission is missing (wire.md section 2)
  NoSample,        ///< `$AA4` before the first `#**`
  // Modbus exceptions; modbus.cpp maps these reasons to exception codes
  UnknownFunction,     ///< 01
  UnknownSubfunction,  ///< 01 in functions 08 and 2B, 02 in function 46
  WrongLength,         ///< 03; also if the byte count does not match the quantity or the length
  WrongQuantity,       ///< 03
  WrongCoilValue,      ///< 03: function 05 with a value other than FF00 and 0000
  WrongAddress,        ///< 02
  WrongValue,          ///< 03; in ASCII, the reply to `~AAX` is `?AA`
  UnknownObject,       ///< 02, in function 2B/0E
  // both protocols
  OutputsBlocked,  ///< ASCII `!`, Modbus 04: the timeout status is set
  StoreFailed,     ///< ASCII `?AA`, Modbus 04: the memory did not store the settings
};

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
  BitWrite drive_;
  TimedDrive timed_drive_;
  SettingsChange change_;
};

}  // namespace ex9000
