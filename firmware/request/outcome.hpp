// What a request comes to: a refusal or an answer, and what the module has to do before it is sent.
#pragma once

#include <cstdint>

#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// Why a request that reached this module is not carried out. Nothing is changed then.
enum class Refusal : std::uint8_t {
  None,
  // ASCII: `?AA`, `?` for commands that set outputs
  UnknownCommand,  ///< no command of this model has this form
  OutOfRange,      ///< the form is right, a value is not
  NotPermitted,    ///< needs INIT* (marked (I))
  NoSample,        ///< `$AA4` before any `#**`
  // Modbus exceptions; the names say what was wrong, the codes are in modbus.cpp
  UnknownFunction,     ///< 01
  UnknownSubfunction,  ///< 01 for 08 and 2B, 02 for 46
  WrongLength,         ///< 03, also a byte count that does not fit
  WrongQuantity,       ///< 03
  WrongCoilValue,      ///< 03: 05 with neither FF00 nor 0000
  WrongAddress,        ///< 02
  WrongValue,          ///< 03
  UnknownObject,       ///< 02: 2B/0E
  // both
  OutputsBlocked,  ///< ASCII `!`, Modbus 04: the timeout status is set
  StoreFailed,     ///< ASCII `?AA`, Modbus 04: the memory did not take it
};

/// Outputs to be driven: the channels of `mask` to the bits of `value`.
struct Drive {
  std::uint16_t mask = 0;
  std::uint16_t value = 0;
};

/// What a request does beside settings and outputs, when all else is done.
enum class Effect : std::uint8_t {
  RestartHostWatchdog,
  TakeAddress,  ///< answer to the stored address from now on
  TakeSample,
  MarkSampleRead,
  ClearResetStatus,
  ClearLatches,
  ClearDiagnostics,
  ClearCounters,
};

/// What must be done, in one go, before the reply leaves. A change of settings is stored first; all else
/// happens when it is stored.
class Outcome {
 public:
  void request(Effect effect) { effects_ = static_cast<std::uint16_t>(effects_ | bit(effect)); }
  [[nodiscard]] bool asks_for(Effect effect) const { return (effects_ & bit(effect)) != 0; }
  [[nodiscard]] bool has_effects() const { return effects_ != 0; }

  void drive(Drive outputs) { drive_ = outputs; }
  /// An empty mask if none is to be driven.
  [[nodiscard]] Drive outputs_to_drive() const { return drive_; }

  /// The change of settings, to be added to.
  SettingsChange& change() {
    changes_settings_ = true;
    return change_;
  }
  [[nodiscard]] const SettingsChange& change() const { return change_; }
  [[nodiscard]] bool changes_settings() const { return changes_settings_; }

  /// Nothing must be done any more. The reason of a refusal stays.
  void clear() {
    effects_ = 0;
    drive_ = {};
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
  Drive drive_;
  SettingsChange change_;
};

}  // namespace ex9000
