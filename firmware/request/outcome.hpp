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
  RestartHostWatchdog = 1U << 0U,
  TakeAddress = 1U << 1U,  ///< answer to the stored address from now on
  TakeSample = 1U << 2U,
  MarkSampleRead = 1U << 3U,
  ClearResetStatus = 1U << 4U,
  ClearLatches = 1U << 5U,
  ClearDiagnostics = 1U << 6U,
  ClearCounters = 1U << 7U,
};

/// What is to be done, in one go, before the reply leaves. A change of settings is stored first; all else
/// happens when it is.
class Outcome {
 public:
  [[gnu::noinline]] void request(Effect effect) {
    asked_ = static_cast<std::uint16_t>(asked_ | static_cast<std::uint8_t>(effect));
  }
  [[nodiscard]] bool asks_for(Effect effect) const {
    return (asked_ & static_cast<std::uint8_t>(effect)) != 0;
  }
  [[nodiscard]] bool has_effects() const { return (asked_ & kEffects) != 0; }

  void drive(Drive outputs) {
    drive_ = outputs;
    asked_ |= kDrive;
  }
  [[nodiscard]] Drive outputs_to_drive() const { return (asked_ & kDrive) != 0 ? drive_ : Drive(); }

  /// The change of settings, to be added to.
  [[gnu::noinline]] SettingsChange& change() {
    asked_ |= kChange;
    return change_;
  }
  [[nodiscard]] const SettingsChange& change() const { return change_; }
  [[nodiscard]] bool changes_settings() const { return (asked_ & kChange) != 0; }

  /// Nothing is to be done but to answer.
  [[nodiscard]] bool empty() const { return asked_ == 0; }
  /// Nothing is to be done any more; why a request was refused, stays.
  void clear() {
    asked_ = 0;
    change_.clear();
  }

  Refusal refusal = Refusal::None;
  std::uint8_t counters_to_clear = 0;  ///< bit n: counter n; for Effect::ClearCounters

 private:
  static constexpr std::uint16_t kEffects = 0xFF;
  static constexpr std::uint16_t kDrive = 0x100;
  static constexpr std::uint16_t kChange = 0x200;

  std::uint16_t asked_ = 0;
  Drive drive_;
  SettingsChange change_;
};

}  // namespace ex9000
