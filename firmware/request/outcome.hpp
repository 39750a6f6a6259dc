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

/// What is to be done, in one go, before the reply leaves. A change of settings is stored first; all else
/// happens when it is.
struct Outcome {
  static constexpr Outcome refused(Refusal why) {
    Outcome outcome;
    outcome.refusal = why;
    return outcome;
  }

  Refusal refusal = Refusal::None;
  SettingsChange change;
  Drive drive;
  bool restart_host_watchdog = false;
  bool take_address = false;  ///< answer to the stored address from now on
  bool take_sample = false;
  bool sample_read = false;
  bool reset_status_read = false;
  bool clear_latches = false;
  std::uint16_t clear_counters = 0;  ///< bit n: counter n
  bool clear_diagnostics = false;
};

}  // namespace ex9000
