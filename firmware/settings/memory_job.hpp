// What the module asks of its memory, and what that reports. See hal/memory.hpp.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"

namespace ex9000 {

/// Load: copies the newest good record of `model` to `record` (kRecordRoom bytes). If there is none, `record`
/// stays the same; the load fails if also a part of the memory does not answer.
///
/// Save: only after a load that succeeded. Writes `record`, whose sequence must follow that of the newest
/// one, and reads it back, up to `attempts` times. If the power fails, a reset loads the previous record or
/// this one. A failed save withdraws the record: a reset then loads the previous one.
///
/// Withdraw: tries again to withdraw the record of a failed save. Only if MemoryResult::refused.
struct MemoryJob {
  enum class Kind : std::uint8_t { Load, Save, Withdraw };

  Kind kind = Kind::Load;
  const Model* model = nullptr;
  MutableBytes record;        ///< valid until the job has ended
  std::uint8_t attempts = 0;  ///< for Save, at least 1
};

/// Of the settings that were loaded at reset: register 0x0306 (firmware/extensions.md).
enum class SettingsSource : std::uint8_t {
  Good = 0,        ///< a good record; no other record is bad
  OneCopyBad = 1,  ///< a good record; another one, which may be newer, is bad
  NoneGood = 2,    ///< no good record, but the memory is not blank or does not answer: factory settings
  Blank = 4,       ///< nothing was ever stored: factory settings; 3 is for a record of an older layout
};

/// When a job has ended.
struct MemoryResult {
  bool succeeded = false;
  SettingsSource source = SettingsSource::NoneGood;  ///< of the last load; Good after a successful save
  bool certain = false;  ///< a reset now would certainly load the last record that was loaded or saved
  bool refused = false;  ///< a reset now may load the record of a failed save
};

}  // namespace ex9000
