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
};

/// What is to be done, in one go, before the reply leaves. A change of settings is stored first; all else
/// happens when it is.
class Outcome {
 public:
  void request(Effect effect) {
    effects_ = static_cast<std::uint8_t>(effects_ | static_cast<std::uint8_t>(effect));
  }
  [[nodiscard]] bool asks_for(Effect effect) const {
    return (effects_ & static_cast<std::uint8_t>(effect)) != 0;
  }
  [[nodiscard]] bool has_effects() const { return effects_ != 0; }
  /// Nothing is to be done but to answer.
  [[nodiscard]] bool empty() const {
    return effects_ == 0 && drive.mask == 0 && clear_counters == 0 && change.empty();
  }

  /// Nothing is to be done any more; why a request was refused, stays.
  void clear() {
    change.clear();
    drive = Drive();
    effects_ = 0;
    clear_counters = 0;
  }

  Refusal refusal = Refusal::None;
  SettingsChange change;
  Drive drive;
  std::uint8_t clear_counters = 0;  ///< bit n: counter n

 private:
  std::uint8_t effects_ = 0;
};

}  // namespace ex9000
